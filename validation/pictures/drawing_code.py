"""The code that draws a picture, as a digest.

It is of a function and of all that it reaches by name, in its own module and in `opml.figures`, with what
these modules do when they are imported. Comments, docstrings and layout do not count.
"""

import ast
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from importlib.util import find_spec
from pathlib import Path

ROOM = "opml.figures"
"""The package whose modules are followed into, as all that draws uses them."""


@dataclass
class ModuleNames:
    """The top level of a module: what defines its names, where it imports others from, what else it does."""

    definitions: dict[str, ast.stmt] = field(default_factory=dict)
    imports: dict[str, tuple[str, str]] = field(default_factory=dict)
    effects: list[ast.stmt] = field(default_factory=list)


def digest(function: str) -> str:
    """Return the digest of the code that a function draws with, such as `opml.figures.orbit.orbit_3d`."""
    start = tuple(function.rsplit(".", 1))
    waiting, reached = [start], {}
    while waiting:
        module, name = place = waiting.pop()
        if place in reached:
            continue
        statements = _statements(module, name)
        reached[place] = [_plain(statement) for statement in statements]
        places = (used for statement in statements for used in _places(module, statement))
        waiting += [
            (module, ""),
            *(used for used in places if used[0] in (start[0], module) or _in_room(used)),
        ]
    return hashlib.sha256(repr(sorted(reached.items())).encode()).hexdigest()[:16]


def _in_room(place: tuple[str, str]) -> bool:
    return place[0].startswith(f"{ROOM}.")


@cache
def module_names(name: str) -> ModuleNames:
    """Return the top level of a module, which is not imported."""
    module = ModuleNames()
    for statement in ast.parse(Path(find_spec(name).origin).read_text(encoding="utf-8")).body:
        match statement:
            case ast.ImportFrom(module=source):
                names = {alias.asname or alias.name: (source, alias.name) for alias in statement.names}
                module.imports |= names
            case ast.FunctionDef() | ast.ClassDef():
                module.definitions[statement.name] = statement
            case ast.Assign() | ast.AnnAssign():
                stored = (node for node in ast.walk(statement) if isinstance(node, ast.Name))
                names = [node.id for node in stored if isinstance(node.ctx, ast.Store)]
                module.definitions |= dict.fromkeys(names, statement)
            case ast.Import() | ast.Expr(value=ast.Constant()):  # what a constant means is no code
                pass
            case _:
                module.effects.append(statement)
    return module


def _statements(module: str, name: str) -> list[ast.stmt]:
    """Return what defines a name of a module; of the empty name, what the module does on import."""
    if not name:
        return module_names(module).effects
    definition = module_names(module).definitions.get(name)
    return [definition] if definition else []


def _places(module: str, statement: ast.stmt) -> Iterator[tuple[str, str]]:
    """Yield module and name of what a statement names, through imports."""
    names = module_names(module)
    for node in ast.walk(statement):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            yield ".".join(names.imports.get(node.value.id, ("", ""))), node.attr
        elif isinstance(node, ast.Name):
            yield names.imports.get(node.id, (module, node.id))


def _plain(node: object) -> object:
    """Return a syntax tree as lists and texts, the same under all versions of Python."""
    if isinstance(node, list):
        return [_plain(part) for part in node if not _is_docstring(part)]
    if not isinstance(node, ast.AST):
        return repr(node)
    fields = ((name, value) for name, value in ast.iter_fields(node) if value not in (None, []))
    return [type(node).__name__, *((name, _plain(value)) for name, value in fields)]


def _is_docstring(node: object) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
