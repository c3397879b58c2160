"""Digests of code and settings: tables keep them as their provenance, and a change reruns the rules."""

import ast
import hashlib
import json
import re
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).parents[1]
_NAME = "opml"

# Where a line of imports begins, also behind a colon or semicolon, and all that belongs to it.
_IMPORT = re.compile(
    r"(?:^|[:;])[ \t]*((?:from[ \t]+[.\w]+(?:[ \t]|\\\n)+)?import\b(?:[ \t]*\([^)]*\)|(?:\\\n|[^\n;])*))",
    re.MULTILINE,
)


def settings_digest(settings: Mapping[str, Any]) -> str:
    """Return the SHA-256 of settings (JSON values), whatever the order of their keys."""
    return hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest()


def contents_digest(paths: Iterable[str | Path]) -> str:
    """Return the SHA-256 over the contents of files, in their order; one that is missing counts as empty."""
    digests = (_content_digest(Path(path)) if Path(path).is_file() else b"" for path in paths)
    return hashlib.sha256(b"".join(digests)).hexdigest()


def settings_of_each(settings: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the settings of jobs for one RSO or learner alone, of a job for several.

    These are the job's settings `rsos` or `learners`, in their order; one alone is `rso`, or the only one of
    `learners`.
    """
    if rsos := settings.get("rsos"):
        common = {name: value for name, value in settings.items() if name != "rsos"}
        return [common | {"rso": rso} for rso in rsos]
    return [{**settings, "learners": [learner]} for learner in settings.get("learners", [])]


def script_digest(script: str | Path) -> str:
    """Return the digest of all modules of opml that a script imports; the script's own text is left out."""
    return code_digest(*imports(script))


def imports(script: str | Path) -> set[str]:
    """Return the modules of opml that a script imports directly."""
    return _imports(Path(script), package="")


def code_digest(*modules: str) -> str:
    """Return the SHA-256 over the source of modules of opml and of all modules of opml that they import.

    Imports are read from the source; nothing is run. A data file of the package counts with each module that
    names it in a string.

    modules: dotted names, such as ``opml.catalog.simulate.truth``
    """
    reached = closure(*modules)
    digest = hashlib.sha256()
    data = {path for module in reached for path in _named_data(module)}
    for path in sorted({_path(module) for module in reached} | data):
        digest.update(path.relative_to(_PACKAGE).as_posix().encode() + b"\0")
        digest.update(_content_digest(path))
    return digest.hexdigest()


def commit() -> str:
    """Return the commit that last changed a module of the package; none where it is not in its repository."""
    log = ["git", "-C", str(_PACKAGE), "log", "-1", "--format=%H", "--", "*.py"]
    try:
        return subprocess.run(log, capture_output=True, text=True, check=False).stdout.strip()
    except FileNotFoundError:
        return ""


def closure(*modules: str) -> set[str]:
    """Return modules of opml, all modules of opml that they import, directly or not, and their packages."""
    reached: set[str] = set()
    waiting = {parent for module in modules for parent in _with_parents(module)}
    while waiting:
        module = waiting.pop()
        reached.add(module)
        waiting |= _needed(module) - reached
    return reached


@cache
def _path(module: str) -> Path:
    base = _PACKAGE.joinpath(*module.split(".")[1:])
    for path in (base / "__init__.py", base.with_suffix(".py")):
        if path.is_file():
            return path
    raise ValueError(f"no module {module}")


@cache
def _exists(module: str) -> bool:
    try:
        return _path(module).is_file()
    except ValueError:
        return False


def _with_parents(module: str) -> set[str]:
    """Return a module and the packages above it, whose __init__ is run first."""
    parts = module.split(".")
    return {".".join(parts[: k + 1]) for k in range(len(parts))}


@cache
def _needed(module: str) -> frozenset[str]:
    path = _path(module)
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    return frozenset(_imports(path, package=package))


def _imports(path: Path, *, package: str) -> set[str]:
    modules: set[str] = set()
    for node in _nodes(path):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = list(_imported_from(node, package))
        else:
            continue
        for name in names:
            if name.split(".")[0] == _NAME:
                modules |= {parent for parent in _with_parents(name) if _exists(parent)}
    return modules


def _imported_from(node: ast.ImportFrom, package: str) -> Iterator[str]:
    """Yield the modules that ``from base import a, b`` may import: base, base.a and base.b."""
    above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
    base = ".".join([*above, *([node.module] if node.module else [])])
    yield base
    for alias in node.names:
        yield f"{base}.{alias.name}"


# The workflow asks for the digests of some forty scripts at each start of a job; all share most modules.
@cache
def _named_data(module: str) -> frozenset[Path]:
    text = _text(_path(module))
    return frozenset(path for name, path in _data().items() if f'"{name}"' in text or f"'{name}'" in text)


@cache
def _data() -> dict[str, Path]:
    return {path.name: path for path in (_PACKAGE / "data").rglob("*") if path.is_file()}


@cache
def _content_digest(path: Path) -> bytes:
    return hashlib.sha256(path.read_bytes()).digest()


@cache
def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


@cache
def _nodes(path: Path) -> tuple[ast.AST, ...]:
    """Return the imports of a source file, as nodes of its syntax.

    Its lines of imports are parsed alone, as whole files take a tenth of a plan's time. Where prose looks
    like one of them, the whole file is parsed.
    """
    try:
        return tuple(node for text in _IMPORT.findall(_text(path)) for node in ast.parse(text).body)
    except SyntaxError:
        return tuple(ast.walk(ast.parse(_text(path))))
