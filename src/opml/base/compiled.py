"""Kernels that Numba compiles: how they are decorated, and where their machine code is kept.

The machine code is kept in the user's cache, in a folder named after a kernel's source and all that it
imports: Numba by itself looks at the file of the outermost kernel alone and would miss a change in a force.
All clones and environments with the same source share it.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba.core.caching import UserProvidedCacheLocator

from opml.base.provenance import script_digest

Decorator = Callable[[Callable[..., Any]], Any]
"""Numba infers the types of what a kernel takes and returns, anew for each use."""


def decorators(**options: Any) -> tuple[Decorator, Decorator]:
    """Decorators (compiled, entry) under Numba's `options`.

    The first is of kernels that other kernels call, the second of those that Python calls: their machine code
    is kept.
    """
    return numba.njit(**options), numba.njit(cache=True, **options)


def kernel_folder(source: str | Path) -> str:
    """Name of the folder that holds the machine code of the kernels of a source file."""
    path = Path(source)
    digest = hashlib.sha256(script_digest(path).encode() + path.read_bytes())
    return f"kernels-{path.stem}-{digest.hexdigest()[:16]}"


class SharedLocator(UserProvidedCacheLocator):
    """Keeps machine code below the cache folder by the content of its source alone.

    Numba puts the path and the time of the source into name and stamp, so that each clone would compile for
    itself.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """Name of the folder below the cache folder, see `kernel_folder`."""
        return kernel_folder(py_file)

    def get_source_stamp(self) -> str:
        """The same for all clones: another source is in another folder."""
        return ""


numba.config.CACHE_DIR = os.environ.get("OPML_CACHE") or platformdirs.user_cache_dir("opml")  # type: ignore[attr-defined]  # made at run time
# Numba's own ones follow for where that folder cannot be written.
numba.config.CACHE_LOCATOR_CLASSES = (  # type: ignore[attr-defined]
    f"{SharedLocator.__module__}.{SharedLocator.__name__},InTreeCacheLocator,UserWideCacheLocator"
)
