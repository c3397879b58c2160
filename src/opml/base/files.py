"""Files that are whole or not there: a temporary file takes the name when it is complete."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

FilePath = str | os.PathLike[str]
"""What names a file."""

PROJECT = Path(__file__).parents[1] / "workflow" / "project"
"""The workflow's files, its settings among them, as they come with the package."""


def in_project(path: FilePath) -> Path:
    """Return the path of a project's file; where the project has none, of the one that the package brings."""
    brought = PROJECT / path
    return brought if brought.is_file() and not Path(path).exists() else Path(path)


@contextmanager
def replacing(path: FilePath) -> Iterator[Path]:
    """Yield a temporary path beside `path`, whose folder is made; it takes the name if nothing was raised."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
