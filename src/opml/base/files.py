"""Paths of a project's files; whole files and folders: a temporary one takes the name when it is complete."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

FilePath = str | os.PathLike[str]
"""A path as text or as a path object."""

PROJECT = Path(__file__).parents[1] / "workflow" / "project"
"""Folder of the workflow's files in the package, the settings among them."""

MANUAL = Path(__file__).parents[1] / "manual" / "docs"
"""Folder of the documentation's pages in the package."""


def project_file(path: FilePath) -> Path:
    """Return the path of a project's file; where the project has none, that of the package's own file."""
    packaged = PROJECT / path
    return packaged if packaged.is_file() and not Path(path).exists() else Path(path)


@contextmanager
def replacing(path: FilePath) -> Iterator[Path]:
    """Make the folder of `path`; yield a temporary path there, which becomes `path` if nothing is raised."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def replacing_folder(path: FilePath) -> Iterator[Path]:
    """Yield a new folder, which takes the place of `path` and all that is in it if nothing is raised."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{path.name}.", suffix=".tmp", dir=path.parent) as temporary:
        new, old = Path(temporary, "new"), Path(temporary, "old")
        new.mkdir()
        yield new
        if path.exists():
            os.replace(path, old)
        os.replace(new, path)
