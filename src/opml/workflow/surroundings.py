"""What Snakemake takes for granted where it runs: a cache that can be written, a Python without blanks."""

import os
import sys
import tempfile
from pathlib import Path

import platformdirs


def lend_cache() -> None:
    """Have `.snakemake/cache` stand for the user's, here and in all jobs, where that cannot be written.

    Without one Snakemake would not start, and each job would compile the kernels anew.
    """
    own = Path(platformdirs.user_cache_dir())
    try:
        own.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=own).close()
    except OSError:
        os.environ["XDG_CACHE_HOME"] = str(Path(".snakemake", "cache").resolve())


def name_python() -> None:
    """Have Python found by its name where blanks are in its path: Snakemake starts scripts without quotes."""
    python = Path(sys.executable)
    if len(str(python).split()) > 1:
        os.environ["PATH"] = f"{python.parent}{os.pathsep}{os.environ['PATH']}"
        sys.executable = python.name
