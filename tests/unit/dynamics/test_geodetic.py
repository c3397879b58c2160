"""Geodetic places against ERFA's iteration."""

import erfa
import numba
import numpy as np
import pytest
from support import in_rows

from opml.base.constants import WGS84_A, WGS84_F
from opml.dynamics.kernels.geodetic import geodetic
from opml.dynamics.kernels.lanes import load, sqrt, store

WGS84 = 1


@numba.njit(cache=True, error_model="numpy")
def _geodetic(x, y, z, out):
    for row in range(x.shape[0]):
        px, py, pz = load(x, row), load(y, row), load(z, row)
        found = geodetic(px, py, pz, 1.0 / sqrt(px * px + py * py + pz * pz))
        store(out[0], row, found[0])
        store(out[1], row, found[1])
        store(out[2], row, found[2])
        store(out[3], row, found[3])
        store(out[4], row, found[4])


def places(positions):
    """Altitude, sine and cosine of the latitude, sine and cosine of the longitude: (5, n)."""
    positions = np.atleast_2d(positions)
    rows = [in_rows(positions[:, k]) for k in range(3)]
    out = np.empty((5, *rows[0].shape))
    _geodetic(*rows, out)
    return out.reshape(5, -1)[:, : len(positions)]


@pytest.mark.parametrize(
    ("lowest", "highest"),
    [(0.0, 1e5), (1e5, 1e6), (1e6, 1e7), (1e7, 4e8)],
    ids=["ground", "leo", "meo", "far"],
)
def test_altitude_and_directions_everywhere(lowest, highest):
    rng = np.random.default_rng(1)
    lon, lat = rng.uniform(-np.pi, np.pi, 3000), np.arcsin(rng.uniform(-1.0, 1.0, 3000))
    altitude = rng.uniform(lowest, highest, 3000)
    found = places(erfa.gd2gc(WGS84, lon, lat, altitude))
    # The altitude is a difference of lengths: rounding grows with the distance.
    assert np.abs(found[0] - altitude).max() < 2e-7 + 4e-16 * highest
    expected = [np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)]
    assert np.abs(found[1:] - expected).max() < 1e-12


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("off_axis", [0.0, 1e-6, 0.1])
def test_poles(side, off_axis):
    polar = WGS84_A * (1.0 - WGS84_F) + 500e3
    altitude, sin_lat, cos_lat, sin_lon, cos_lon = places([0.0, off_axis, side * polar])[:, 0]
    assert altitude == pytest.approx(500e3, abs=1e-6)
    assert sin_lat == pytest.approx(side, abs=1e-15)
    assert 0.0 <= cos_lat < 1e-7
    # On the axis the longitude is that of the x axis; beside it, the place's own.
    assert cos_lon == (1.0 if off_axis < 1e-3 else 0.0)
    assert sin_lon == pytest.approx(1.0 if off_axis > 1e-3 else 0.0, abs=2e-3)
