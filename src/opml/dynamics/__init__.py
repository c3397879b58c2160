"""Forces, the integrator and the ensemble that flies many arcs at once, as compiled kernels.

The machine code is kept in the user's cache, in a folder named after the kernels' source: Numba by
itself looks at the file of the outermost kernel alone and would miss a change in a force.
"""

import os
from pathlib import Path

import numba
import platformdirs

from opml.dynamics.caching import SharedLocator
from opml.provenance import code_digest

# The solver of opml.learning keeps its machine code here, too.
_KERNELS = (
    "opml.dynamics.ensemble",
    "opml.dynamics.frames",
    "opml.dynamics.orbit_density",
    "opml.learning.smo_kernels",
)


def _cache_folder() -> Path:
    base = Path(os.environ.get("OPML_CACHE") or platformdirs.user_cache_dir("opml"))
    return base / f"kernels-{code_digest(*_KERNELS)[:16]}"


numba.config.CACHE_DIR = str(_cache_folder())  # type: ignore[attr-defined]  # made at run time
# Numba's own ones follow for where that folder cannot be written.
numba.config.CACHE_LOCATOR_CLASSES = (  # type: ignore[attr-defined]
    f"{SharedLocator.__module__}.{SharedLocator.__name__},InTreeCacheLocator,UserWideCacheLocator"
)
