"""The sections of benchmarks/results.md: what is made anew takes the place of what stood there."""

import re
from collections.abc import Mapping

TITLES = (
    "Beside the peers",
    "Fits beside the peers",
    "Work and precision",
    "Threads",
    "Arcs",
    "RSOs",
    "Least squares",
    "Start of a job",
    "Kernels",
    "Support vector regression",
    "The whole paper",
)
"""All sections, in their order."""


def replaced(page: str, introduction: str, made: Mapping[str, str]) -> str:
    """Return the page under a new introduction; the sections `made`, texts by title, replace its own."""
    _, *old = re.split(r"^## (.+)\n+", page, flags=re.MULTILINE)
    texts = dict(zip(old[::2], old[1::2], strict=True)) | dict(made)
    parts = [f"## {title}\n\n{texts[title].strip()}\n" for title in TITLES if title in texts]
    return "\n".join([introduction, *parts])
