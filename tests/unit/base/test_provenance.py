"""Digests of code: whatever a script imports counts, and nothing else."""

import ast
import shutil
import subprocess
import sys

import pytest
from support import REPOSITORY

from opml.base import provenance
from opml.base.provenance import closure, code_digest, imports, script_digest, settings_digest

SCRIPTS = sorted((REPOSITORY / "workflow" / "scripts").glob("*.py"))


def package(tmp_path, monkeypatch, **sources):
    """A small package in opml's place."""
    root = tmp_path / "opml"
    for name, source in {"__init__": "", "data/figures.csv": "1,2", "data/other.csv": "3", **sources}.items():
        path = root / (name if "." in name else f"{name}.py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(source)
    monkeypatch.setattr(provenance, "_PACKAGE", root)
    forget()
    return root


def forget():
    for name in ("_needed", "_path", "_named_data", "_data", "_content_digest", "_text", "_nodes"):
        getattr(provenance, name).cache_clear()


@pytest.fixture(autouse=True)
def _fresh_caches():
    yield
    forget()


@pytest.fixture
def small(tmp_path, monkeypatch):
    return package(
        tmp_path,
        monkeypatch,
        top="from opml.sub import middle\nimport numpy",
        beside="x = 1",
        lonely="import os",
        **{
            "sub/__init__": "",
            "sub/middle": "from . import low\nfrom .low import value\nfrom ..beside import x",
            "sub/low": "def f():\n    from opml import lazy\nvalue = 'figures.csv'",
            "sub/unused": "y = 2",
            "lazy": "import opml.sub.circle",
            "sub/circle": "from opml import top",
        },
    )


def test_imports_are_followed_whatever_their_form(small):
    reached = {"top", "beside", "lazy", "sub", "sub.middle", "sub.low", "sub.circle"}
    assert closure("opml.top") == {"opml", *(f"opml.{name}" for name in reached)}
    assert closure("opml.lonely") == {"opml", "opml.lonely"}


@pytest.mark.parametrize(
    ("changed", "counts"),
    [
        ("top.py", True),
        ("beside.py", True),
        ("sub/low.py", True),
        ("sub/__init__.py", True),
        ("__init__.py", True),
        ("data/figures.csv", True),
        ("data/other.csv", False),
        ("sub/unused.py", False),
        ("lonely.py", False),
    ],
)
def test_digest_changes_with_what_is_used_only(small, changed, counts):
    before = code_digest("opml.top")
    with (small / changed).open("a") as file:
        file.write("\n")
    forget()
    assert (code_digest("opml.top") != before) == counts


IMPORTS = {
    "in a block": "if True: import opml.lonely",
    "after another": "import os; from opml import lonely",
    "brackets": "from opml import (  # why (so)\n    lonely,  # (and this)\n)",
    "from, cut": "from opml \\\n    import lonely",
    "cut": "import os, \\\n    opml.lonely",
    "as": "import opml.lonely as other  # why; not",
    "behind a text": "x = 'import this (and) that'\nfrom opml import lonely",
    "behind a doc": '"""\nfrom all we know, import no doubt\n"""\nfrom opml import lonely',
}


@pytest.mark.parametrize("source", IMPORTS.values(), ids=IMPORTS)
def test_an_import_is_found_however_it_is_written(tmp_path, monkeypatch, source):
    package(tmp_path, monkeypatch, lonely="", top=source)
    assert closure("opml.top") == {"opml", "opml.top", "opml.lonely"}


def test_the_imports_of_every_module_are_those_of_its_syntax():
    for path in sorted(provenance._PACKAGE.rglob("*.py")):
        nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        imports = {ast.unparse(node) for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)}
        assert imports <= {ast.unparse(node) for node in provenance._nodes(path)}, path


def test_digest_does_not_depend_on_the_place(small, tmp_path, monkeypatch):
    before = code_digest("opml.top")
    shutil.copytree(small, tmp_path / "elsewhere" / "opml")
    monkeypatch.setattr(provenance, "_PACKAGE", tmp_path / "elsewhere" / "opml")
    forget()
    assert code_digest("opml.top") == before


def test_unknown_module_is_an_error():
    with pytest.raises(ValueError, match=r"no module opml\.nonsense"):
        code_digest("opml.nonsense")


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_every_script_has_a_digest_of_its_own_modules(script):
    assert len(script_digest(script)) == 64
    assert "opml.workflow.jobs" in imports(script)


@pytest.mark.slow
def test_nothing_that_python_really_loads_is_missed():
    # The truth is in the interpreter: load what a script imports, and look at what came with it.
    for name in ("estimation", "evaluate", "gravity_field"):
        script = next(path for path in SCRIPTS if path.stem == name)
        modules = sorted(imports(script))
        code = (
            f"import sys, {', '.join(modules)}\nprint(*(m for m in sys.modules if m.split('.')[0] == 'opml'))"
        )
        loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert set(loaded.stdout.split()) <= closure(*modules)


def test_settings_digest_ignores_the_order_of_keys():
    assert settings_digest({"a": 1, "b": {"c": 2, "d": 3}}) == settings_digest(
        {"b": {"d": 3, "c": 2}, "a": 1}
    )
    assert settings_digest({"a": 1}) != settings_digest({"a": 1.5})
