"""Decorators of the kernels that Numba compiles, and the cache of their machine code.

Machine code lies in the user's cache, in a folder named by a digest of the kernel's source and of all that it
imports. Numba itself compares the outermost kernel's file alone, and would miss a change in a force.
All clones and environments with the same source share the folder.
"""

import hashlib
import importlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba.core.caching import UserProvidedCacheLocator
from numba.extending import register_jitable
from numba.np import linalg

from opml.base.errors import InputError
from opml.base.linked_kernels import LinkedKernels
from opml.base.provenance import script_digest

Decorator = Callable[[Callable[..., Any]], Any]
"""A decorator of kernels; Numba infers their types at each use."""


# Numba looks for SciPy's BLAS, a quarter of a second, before any kernel multiplies matrices, and again then.
_ensure_blas, linalg.ensure_blas = linalg.ensure_blas, lambda: None
importlib.import_module("numba.np.arraymath")
linalg.ensure_blas = _ensure_blas


def decorators(**options: Any) -> tuple[Decorator, Decorator]:
    """Return the decorators (compiled, entry) under Numba's `options`.

    compiled: of a kernel that other kernels call; for Python it is the function as written
    entry: of a kernel that Python calls; its machine code is kept. Raises InputError where no folder
        can hold it: each process would compile again.
    """

    def entry(kernel: Callable[..., Any]) -> Any:
        try:
            return numba.njit(cache=True, **options)(kernel)
        except RuntimeError as error:
            folder = numba.config.CACHE_DIR  # type: ignore[attr-defined]  # made at run time
            raise InputError(f"{folder}: expected a folder for compiled kernels: set OPML_CACHE") from error

    to_link = {"pipeline_class": LinkedKernels, "no_cfunc_wrapper": True}
    return register_jitable(inline="never", **to_link, **options), entry


def kernel_folder(source: str | Path) -> str:
    """Return the name of the folder for the machine code of a source file's kernels."""
    path = Path(source)
    digest = hashlib.sha256(script_digest(path).encode() + path.read_bytes())
    return f"kernels-{path.stem}-{digest.hexdigest()[:16]}"


class SharedLocator(UserProvidedCacheLocator):
    """A place for machine code below the cache folder that depends on the source's content alone.

    Numba's own place depends on the source's path and time, so that each clone would compile for itself.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """Return the name of the folder below the cache folder, see `kernel_folder`."""
        return kernel_folder(py_file)

    def get_source_stamp(self) -> str:
        """Return the same stamp for all clones: another source has another folder."""
        return ""


numba.config.CACHE_DIR = os.environ.get("OPML_CACHE") or platformdirs.user_cache_dir("opml")  # type: ignore[attr-defined]  # made at run time
# Numba's own places follow, for a cache folder that cannot be written.
numba.config.CACHE_LOCATOR_CLASSES = (  # type: ignore[attr-defined]
    f"{SharedLocator.__module__}.{SharedLocator.__name__},InTreeCacheLocator,UserWideCacheLocator"
)
