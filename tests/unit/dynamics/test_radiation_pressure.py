"""Radiation pressure, and the shadow against rays traced past the ellipsoid."""

import numba
import numpy as np
from support import in_rows

from opml.base.constants import SRP_DISTANCE, SRP_PRESSURE, SUN_RADIUS, WGS84_A, WGS84_F
from opml.dynamics.kernels.lanes import load, splat, store
from opml.dynamics.kernels.radiation_pressure import illumination, lit_part, radiation_pressure

POLAR = WGS84_A * (1.0 - WGS84_F)
AU = 1.496e11


@numba.njit(cache=True, error_model="numpy")
def _illumination(x, y, z, sun, scratch, out):
    for row in range(x.shape[0]):
        px, py, pz = load(x, row), load(y, row), load(z, row)
        store(out, row, illumination(px, py, pz, px * px + py * py + pz * pz, sun, scratch))


@numba.njit(cache=True, error_model="numpy")
def _lit_parts(positions, sun):
    return np.array([lit_part(p[0], p[1], p[2], sun) for p in positions])


@numba.njit(cache=True, error_model="numpy")
def _pressure(x, y, z, sun, lit, coefficient, out):
    ax, ay, az = radiation_pressure(load(x, 0), load(y, 0), load(z, 0), sun, splat(lit), splat(coefficient))
    store(out, 0, ax)
    store(out, 1, ay)
    store(out, 2, az)


def lit(positions, sun):
    """Part of the Sun in sight of positions (n, 3), the Sun at `sun` (3,)."""
    positions = np.atleast_2d(positions)
    rows = [in_rows(positions[:, k]) for k in range(3)]
    out = np.empty_like(rows[0])
    _illumination(*rows, np.array(sun), np.empty((4, rows[0].shape[1])), out)
    return out.ravel()[: len(positions)]


def pressure(position, sun, part=1.0, coefficient=0.0625):
    rows = [in_rows([value]) for value in position]
    out = np.empty((3, rows[0].shape[1]))
    _pressure(*rows, np.array(sun), part, coefficient, out)
    return out[:, 0]


def traced(position, sun, rings=60):
    """Part of the Sun's disc whose rays reach a point: rays tested one by one against the ellipsoid."""
    to_sun = sun - position
    axis = to_sun / np.linalg.norm(to_sun)
    side = np.linalg.svd(axis[None])[2][1:]
    radii = SUN_RADIUS * np.sqrt((np.arange(rings) + 0.5) / rings)
    angles = 2.0 * np.pi * (np.arange(4 * rings) + 0.5) / (4 * rings)
    disc = (
        radii[:, None, None] * (np.cos(angles)[:, None] * side[0] + np.sin(angles)[:, None] * side[1])
    ).reshape(-1, 3)
    shape = np.array([1.0, 1.0, WGS84_A / POLAR])
    start, ray = position * shape, (to_sun + disc) * shape
    nearest = start - (ray @ start / np.sum(ray**2, axis=1))[:, None] * ray
    hidden = (ray @ start < 0.0) & (np.sum(nearest**2, axis=1) < WGS84_A**2)
    return 1.0 - hidden.mean()


def test_it_points_away_from_the_sun_and_falls_with_the_square_of_the_distance():
    position = np.array([1e6, 7e6, -2e6])
    away = np.array([0.6, 0.0, -0.8])
    found = pressure(position, position - SRP_DISTANCE * away)
    np.testing.assert_allclose(found, SRP_PRESSURE * 0.0625 * away, rtol=1e-14, atol=1e-22)
    np.testing.assert_allclose(
        pressure(position, position - 2 * SRP_DISTANCE * away), found / 4, rtol=1e-14, atol=1e-22
    )
    np.testing.assert_allclose(
        pressure(position, position - SRP_DISTANCE * away, 0.3, 0.125), 0.6 * found, rtol=1e-14
    )


def test_full_sun_and_umbra():
    sun = [AU, 0.0, 0.0]
    assert np.all(lit([[7e6, 0, 0], [0, 7e6, 0], [-7e6, 6.6e6, 0], [-4.2e7, 0, 7e6]], sun) == 1.0)
    assert np.all(lit([[-7e6, 0, 0], [-7e6, 6.2e6, 0], [-7e6, 0, -6.2e6], [-4.2e7, 1e5, 0]], sun) == 0.0)


def test_the_short_cut_never_changes_the_answer():
    rng = np.random.default_rng(1)
    for _ in range(5):
        sun = rng.normal(size=3)
        sun *= AU / np.linalg.norm(sun)
        along, angle = rng.uniform(-5e7, 5e7, 3000), rng.uniform(0.0, 2.0 * np.pi, 3000)
        # Most of them around the edge of the shadow.
        across = np.where(rng.random(3000) < 0.7, rng.normal(WGS84_A, 1e5, 3000), rng.uniform(0.0, 4e7, 3000))
        axes = np.linalg.svd(sun[None])[2]
        axes[0] = sun / AU
        positions = np.stack([along, across * np.cos(angle), across * np.sin(angle)], axis=1) @ axes
        positions = positions[np.linalg.norm(positions, axis=1) > WGS84_A + 100e3]
        found = lit(positions, sun)
        np.testing.assert_array_equal(found, _lit_parts(positions, sun))
        assert np.any((found > 0.0) & (found < 1.0))


def test_the_shadow_is_that_of_rays_past_the_ellipsoid():
    rng = np.random.default_rng(2)
    sun = AU * np.array([0.8, 0.5, -np.sqrt(0.11)])
    axes = np.linalg.svd(sun[None])[2]
    axes[0] = sun / AU
    errors, parts = [], []
    for _ in range(60):
        along, angle = -rng.uniform(2.0e6, 4e7), rng.uniform(0.0, 2.0 * np.pi)
        limb = WGS84_A - 10e3 + rng.uniform(-0.0055, 0.0055) * -along + rng.normal(0.0, 5e3)
        position = np.array([along, limb * np.cos(angle), limb * np.sin(angle)]) @ axes
        errors.append(lit(position, sun)[0] - traced(position, sun))
        parts.append(lit(position, sun)[0])
    assert np.sum((np.array(parts) > 0.02) & (np.array(parts) < 0.98)) > 20
    assert np.abs(errors).max() < 0.01
