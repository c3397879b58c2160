"""Compiled kernels are kept once for all clones of the same source."""

from pathlib import Path

import numba

from opml.dynamics import ensemble, frames
from opml.dynamics.caching import SharedLocator
from opml.learning import smo_kernels


def test_kernels_are_kept_by_their_source_not_by_its_path():
    for kernel in (ensemble.advance, frames._rotations):
        assert Path(kernel._cache.cache_path) == Path(numba.config.CACHE_DIR) / "dynamics"


def test_the_solver_of_the_svr_is_kept_beside_them():
    assert Path(smo_kernels.descend._cache.cache_path) == Path(numba.config.CACHE_DIR) / "learning"


def test_two_clones_name_the_same_folder():
    paths = [f"/{clone}/src/opml/dynamics/flight.py" for clone in ("one", "two")]
    assert {SharedLocator.get_suitable_cache_subpath(path) for path in paths} == {"dynamics"}
