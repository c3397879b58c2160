"""The inside of the package: what its modules import, and how they name things."""

import ast
from collections import Counter
from graphlib import TopologicalSorter
from pathlib import Path

import grimp
from support import REPOSITORY

PACKAGE = REPOSITORY / "src" / "opml"
LINKED = [PACKAGE / "manual", PACKAGE / "workflow" / "project"]
PARTICIPLES = {
    *("begun", "between", "carried", "chosen", "drawn", "edited", "ended", "fitted", "found", "free", "held"),
    *("issued", "judged", "kept", "known", "left", "made", "shown", "spoilt", "undisturbed", "whitened"),
}


def definitions(*kinds: type[ast.AST]) -> list[tuple[str, Path]]:
    """Return the public names that the package's own modules define, each with its module."""
    modules = [path for path in PACKAGE.rglob("*.py") if not any(map(path.is_relative_to, LINKED))]
    return [
        (node.name, path.relative_to(PACKAGE))
        for path in modules
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, kinds) and not node.name.startswith("_")
    ]


def test_no_modules_import_each_other():
    graph = grimp.build_graph("opml", cache_dir=None)  # with what is imported for types alone
    TopologicalSorter(
        {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    ).prepare()


def test_no_type_has_its_name_in_two_modules():
    modules = Counter(name for name, _ in set(definitions(ast.ClassDef)))
    assert len(modules) > 100
    assert [name for name, count in modules.items() if count > 1] == []


def test_functions_are_named_by_verbs_or_nouns():
    functions = definitions(ast.FunctionDef)
    assert len(functions) > 1000
    assert [(name, str(path)) for name, path in functions if name in PARTICIPLES] == []
