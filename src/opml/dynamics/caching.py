"""Where Numba keeps the compiled kernels: one place for all clones and environments with the same source."""

from pathlib import Path

from numba.core.caching import UserProvidedCacheLocator


class SharedLocator(UserProvidedCacheLocator):
    """Keeps machine code below the cache folder by the package's name alone.

    Numba puts the path of the source into the name, so that each clone would compile for itself. The cache
    folder is named after the content of the source already.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """Return the name of the folder that a source file is in."""
        return Path(py_file).parent.name
