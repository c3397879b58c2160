"""The inside of the package: what its modules import."""

from graphlib import TopologicalSorter

import grimp


def test_no_modules_import_each_other():
    graph = grimp.build_graph("opml", cache_dir=None)  # with what is imported for types alone
    TopologicalSorter(
        {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    ).prepare()
