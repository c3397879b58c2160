"""The inside of the package: what its modules import, and how they name things."""

import ast
import re
from collections import Counter
from graphlib import TopologicalSorter
from itertools import chain
from pathlib import Path

import grimp
import pytest
from support import REPOSITORY

PACKAGE = REPOSITORY / "src" / "opml"
LINKED = [PACKAGE / "manual", PACKAGE / "workflow" / "project"]
PARTICIPLES = {
    *("begun", "between", "carried", "chosen", "drawn", "edited", "ended", "fitted", "found", "free", "held"),
    *("issued", "judged", "kept", "known", "left", "made", "shown", "spoilt", "undisturbed", "whitened"),
}


@pytest.fixture(scope="module")
def nodes():
    """All nodes of the syntax of each of the package's own modules, the module itself first."""
    own = [path for path in PACKAGE.rglob("*.py") if not any(map(path.is_relative_to, LINKED))]
    return {path: [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))] for path in own}


def definitions(nodes, kind: type[ast.AST]) -> list[tuple[str, Path]]:
    """Return the public names that the package's own modules define, each with its module."""
    return [
        (node.name, path.relative_to(PACKAGE))
        for path, parts in nodes.items()
        for node in parts
        if isinstance(node, kind) and not node.name.startswith("_")
    ]


def test_no_modules_import_each_other():
    graph = grimp.build_graph("opml", cache_dir=None)  # with what is imported for types alone
    TopologicalSorter(
        {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    ).prepare()


def test_no_type_has_its_name_in_two_modules(nodes):
    modules = Counter(name for name, _ in set(definitions(nodes, ast.ClassDef)))
    assert len(modules) > 100
    assert [name for name, count in modules.items() if count > 1] == []


def test_functions_are_named_by_verbs_or_nouns(nodes):
    functions = definitions(nodes, ast.FunctionDef)
    assert len(functions) > 1000
    assert [(name, str(path)) for name, path in functions if name in PARTICIPLES] == []


def top_level(tree: ast.Module) -> set[str]:
    """Return the names that a module itself defines."""
    stored = (ast.FunctionDef, ast.ClassDef)
    own = [node for node in tree.body if not isinstance(node, (*stored, ast.Import, ast.ImportFrom))]
    names = {node.id for part in own for node in ast.walk(part) if isinstance(node, ast.Name)}
    return names | {node.name for node in tree.body if isinstance(node, stored)}


@pytest.mark.parametrize("facade", ["naming", "tables"])
def test_what_is_taken_from_a_facade_is_its_own(facade, nodes):
    """The star imports of a facade pass on what its modules import, too."""
    own = set().union(*(top_level(parts[0]) for path, parts in nodes.items() if path.parent.name == facade))
    taken = {
        alias.name
        for parts in nodes.values()
        for node in parts
        if isinstance(node, ast.ImportFrom) and node.module == f"opml.{facade}"
        for alias in node.names
    }
    assert len(taken) > 5
    assert sorted(taken - own) == []


MOST = {
    "lines of the package": 39_982,
    "lines of tests": 30_816,
    "classes": 262,
    "docstrings that begin with what, which, how, where, of": 0,
    "variables called found, one, made, told": 0,
}
"""Limits of the house. A change that adds pays in the same change; a change that removes lowers them."""


def test_the_house_does_not_grow(nodes):
    texts, every = [path.read_text(encoding="utf-8") for path in nodes], [*chain(*nodes.values())]
    described = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docstrings = [ast.get_docstring(node) or "" for node in every if isinstance(node, described)]
    tests = (REPOSITORY / "tests").rglob("*.py")
    counts = (
        sum(len(text.splitlines()) for text in texts),
        sum(len(path.read_text(encoding="utf-8").splitlines()) for path in tests),
        sum(isinstance(node, ast.ClassDef) for node in every),
        sum(bool(re.match(r"(What|Which|How|Where|Of)\b", text)) for text in docstrings),
        sum(len(re.findall(r"(?m)^ *(?:found|one|made|told) =", text)) for text in texts),
    )
    assert [(name, n) for (name, most), n in zip(MOST.items(), counts, strict=True) if n > most] == []
