"""Packages that parts of the workflow need beyond the extra `workflow`, and a note where one is missing."""

from importlib.util import find_spec

NO_EXPLORE = (
    "opml: pages to explore are left out of a study's files, as plotly is not installed: "
    "pip install 'opml-orbits[explore]'"
)


def can_explore() -> bool:
    """Return whether the package that draws the pages to explore is installed."""
    return find_spec("plotly") is not None
