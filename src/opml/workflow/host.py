"""Prerequisites of Snakemake on a host: a cache that can be written, a Python without blanks."""

import os
import sys
import tempfile
from pathlib import Path

import platformdirs


def lend_cache() -> None:
    """Have another folder stand for the user's cache, here and in all jobs, where that cannot be written.

    It is next to the installed packages, which all projects share, or in the folder of the run. Without one
    Snakemake would not start, and each job would compile the kernels again.
    """
    if not _can_be_written(Path(platformdirs.user_cache_dir())):
        shared = Path(sys.prefix, "cache")
        lent = shared if _can_be_written(shared) else Path(".snakemake", "cache").resolve()
        os.environ["XDG_CACHE_HOME"] = str(lent)


def _can_be_written(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def name_python() -> None:
    """Have Python found by its name where blanks are in its path: Snakemake starts scripts without quotes."""
    python = Path(sys.executable)
    if len(str(python).split()) > 1:
        os.environ["PATH"] = f"{python.parent}{os.pathsep}{os.environ['PATH']}"
        sys.executable = python.name
