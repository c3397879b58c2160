"""DTM2000 against its published cases, against Orekit's over the paper's days, and how it behaves."""

import erfa
import numba
import numpy as np
import pandas as pd
import pytest
from scipy.special import lpmv
from support import EXCERPTS, force_model, in_rows, shared

from opml.base.constants import DAY
from opml.dynamics.kernels import acceleration, dtm2000
from opml.dynamics.kernels.acceleration import SCRATCH_ROWS
from opml.dynamics.kernels.lanes import WIDTH, load, splat, sqrt, store
from opml.dynamics.kernels.surroundings import BODIES, look_up

COEFFICIENTS = dtm2000.coefficients()


@numba.njit(cache=True, error_model="numpy")
def _density(rows, a, factors, basis, out):
    rho = dtm2000.density(
        load(rows, 0), load(rows, 1), load(rows, 2), load(rows, 3), load(rows, 4), load(rows, 5),
        load(rows, 6), a, factors, basis,
    )  # fmt: skip
    store(out, 0, rho)


@numba.njit(cache=True, error_model="numpy")
def _reduce(a, season, f107, f107_mean, kp_3h, kp_24h, factors):
    dtm2000.reduce_to_date(a, season, f107, f107_mean, kp_3h, kp_24h, factors)


@numba.njit(cache=True, error_model="numpy")
def _density_at(t, positions, model, values, factors, scratch, out):
    look_up(t, model, values, factors)
    x, y, z = load(positions, 0), load(positions, 1), load(positions, 2)
    altitude, rho = acceleration.density(
        x, y, z, 1.0 / sqrt(x * x + y * y + z * z), splat(0.0), model, values, factors, scratch
    )
    store(out, 0, altitude)
    store(out, 1, rho)


def density(
    *, day=100.0, altitude=400e3, lat=0.5, lon=1.0, time=2.0, f107=83.0, mean=83.0, kp=2.4, kp_mean=2.4
):
    """Density [kg/m3]; latitude, longitude and local time (0 at midnight) in radians, arrays broadcast."""
    factors = np.empty((dtm2000.FACTORS, WIDTH))
    season = np.ascontiguousarray(dtm2000.seasons(COEFFICIENTS, [day])[0])
    _reduce(COEFFICIENTS, season, *map(float, (f107, mean, kp, kp_mean)), factors)
    altitude, lat, lon, time = np.broadcast_arrays(altitude, lat, lon, time)
    columns = [altitude, np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon), np.sin(time), np.cos(time)]
    blocks = np.stack([in_rows(np.ravel(column)) for column in columns], axis=1)
    out, basis = np.empty((len(blocks), 1, WIDTH)), np.empty((SCRATCH_ROWS, WIDTH))
    for rows, found in zip(blocks, out, strict=True):
        _density(rows, COEFFICIENTS, factors, basis, found)
    return out.ravel()[: altitude.size].reshape(altitude.shape)


def test_published_cases():
    cases = pd.read_csv(EXCERPTS / "dtm2000.csv", comment="#")
    for case in cases.itertuples():
        found = density(
            day=case.day_of_year,
            altitude=case.altitude,
            lat=np.radians(case.latitude),
            lon=np.radians(case.longitude),
            time=np.radians(15.0 * case.local_time),
            f107=case.f107,
            mean=case.f107_mean,
            kp=case.kp_3h,
            kp_mean=case.kp_24h,
        )
        assert found == pytest.approx(case.density, rel=3e-13), case


def terms(day, lat, lon, time, df, dm, kp, km, sign, a):
    """The model's terms by the index of their coefficient: (constant ones, flux ones, periodic ones)."""

    def p(n, m=0, x=None):
        return (-1.0) ** m * lpmv(m, n, np.sin(lat) if x is None else x)

    pole = np.array([0.19081 * np.cos(1.2392), -0.19081 * np.sin(1.2392), 0.98163])
    magnetic = pole @ [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]
    year = 0.017214206
    even, even2 = np.cos(year * (day - a[11])), np.cos(2 * year * (day - a[14]))
    odd, odd2 = np.cos(year * (day - a[18])), np.cos(2 * year * (day - a[20]))
    flux = {4: df, 5: df**2, 6: dm, 69: dm**2, 82: df * p(1), 83: df * p(2), 84: df * p(3)}
    flux |= {85: dm * p(2), 86: dm * p(3), 87: dm * p(4)}
    constant = {2: p(2), 3: p(4), 74: sign * p(1), 77: sign * p(3), 78: sign * p(5), 79: p(6)}
    for k, indices in ((kp, (7, 8, 68, 60, 61, 75)), (km, (64, 65, 72, 66, 73, 76))):
        p2, p4 = p(2, x=magnetic), p(4, x=magnetic)
        constant |= dict(zip(indices, (k, k * p2, k * p4, k**2, k**2 * p2, k**4), strict=True))
    periodic = {9: even, 10: p(2) * even, 12: even2, 13: p(2) * even2}
    for n, (annual, half, active) in {1: (15, 19, 40), 3: (16, 39, 41), 5: (17, 59, 42)}.items():
        periodic |= {annual: p(n) * odd, half: p(n) * odd2, active: p(n) * odd * kp}
    for wave, hour, hour_active, seasonal in (
        (np.cos(time), (21, 22, 23), (43, 44, 45), (24, 25)),
        (np.sin(time), (26, 27, 28), (46, 47, 48), (29, 30)),
    ):
        for n, plain, active in zip((1, 3, 5), hour, hour_active, strict=True):
            periodic |= {plain: p(n, 1) * wave, active: p(n, 1) * wave * kp}
        periodic |= {seasonal[0]: p(1, 1) * wave * odd, seasonal[1]: p(2, 1) * wave * odd}
    for wave, indices in (
        (np.cos(2 * time), (31, 37, 32, 88, 90, 92)),
        (np.sin(2 * time), (33, 38, 34, 89, 91, 93)),
    ):
        shapes = (p(2, 2), p(4, 2), p(3, 2) * odd, sign * p(3, 2), sign * p(5, 2), p(6, 2))
        periodic |= {index: shape * wave for index, shape in zip(indices, shapes, strict=True)}
    periodic |= {35: p(3, 3) * np.cos(3 * time), 36: p(3, 3) * np.sin(3 * time)}
    for n in range(1, 6):
        periodic |= {48 + n: p(n, 1) * np.cos(lon), 53 + n: p(n, 1) * np.sin(lon)}
    return constant, flux, periodic


def plain_density(*, day, altitude, lat, lon, time, f107, mean, kp, kp_mean):
    """Density [kg/m3] of one place, term by term as the paper lists them, with SciPy's Legendre functions."""
    g = {}
    for k, name in enumerate(dtm2000.QUANTITIES):
        a = COEFFICIENTS[:, k]
        sign = dtm2000.seasons(COEFFICIENTS, [day])[0, 4, k]
        constant, flux, periodic = terms(day, lat, lon, time, f107 - mean, mean - 150.0, kp, kp_mean, sign, a)
        constant, flux, periodic = (
            sum(a[n] * term for n, term in part.items()) for part in (constant, flux, periodic)
        )
        coupled = name in ("tt", "o", "n2", "o2", "n")
        g[name] = constant + flux + periodic * (1.0 + coupled * flux)
    base = dict(zip(dtm2000.QUANTITIES, COEFFICIENTS[1, : len(dtm2000.QUANTITIES)], strict=True))
    t_inf, t_120, slope = base["tt"] * (1.0 + g["tt"]), base["t0"] + g["t0"], base["tp"] + g["tp"]
    radius, z = 6356.77, altitude / 1e3
    sigma, xi = slope / (t_inf - t_120), (z - 120.0) * (radius + 120.0) / (radius + z)
    t_z = t_inf - (t_inf - t_120) * np.exp(-sigma * xi)
    gravity = 980.665 / (1.0 + 120.0 / radius) ** 2
    total = 0.0
    for name, mass, thermal in (
        *(("h", 1, -0.40), ("he", 4, -0.38), ("o", 16, 0.0)),
        *(("n2", 28, 0.0), ("o2", 32, 0.0), ("n", 14, 0.0)),
    ):
        gamma = mass * gravity / (831.4 * sigma * t_inf)
        profile = (t_120 / t_z) ** (1.0 + thermal + gamma) * np.exp(-sigma * gamma * xi)
        total += base[name] * np.exp(g[name]) * profile * mass * 1.6606e-24
    return 1e3 * total


def test_every_term_where_flux_and_geomagnetic_activity_change():
    rng = np.random.default_rng(1)
    for _ in range(40):
        case = {
            "day": float(rng.integers(1, 367)),
            "altitude": rng.uniform(130e3, 1200e3),
            "lat": rng.uniform(-1.5, 1.5),
            "lon": rng.uniform(-3.0, 3.0),
            "time": rng.uniform(0.0, 6.0),
            "f107": rng.uniform(70.0, 250.0),
            "mean": rng.uniform(70.0, 200.0),
            "kp": rng.uniform(0.0, 8.0),
            "kp_mean": rng.uniform(0.0, 6.0),
        }
        # The constituents' masses are rounded to five figures in the model.
        assert density(**case) == pytest.approx(plain_density(**case), rel=2e-5), case


def test_orekits_densities_between_150_and_1500_km():
    cases = pd.read_parquet(shared("reference/density.parquet"))
    model = force_model(8)
    values = np.empty(BODIES + model.bodies.shape[1])
    factors, scratch = np.empty((dtm2000.FACTORS, WIDTH)), np.empty((SCRATCH_ROWS, WIDTH))
    out, errors = np.empty((2, WIDTH)), []
    for case in cases.itertuples():
        position = erfa.gd2gc(1, case.lon_rad, case.lat_rad, case.alt_m)
        rows = np.repeat(position[:, None], WIDTH, axis=1)
        _density_at(case.t_s, rows, model, values, factors, scratch, out)
        assert out[0, 0] == pytest.approx(case.alt_m, abs=1e-6)
        errors.append(out[1, 0] / case.density_kgpm3 - 1.0)
    # The Sun's direction is that of DE430 there and of DE440 here, Kp comes from Ap by another rounding.
    assert np.abs(errors).max() < 3e-9


def test_below_its_lower_boundary_it_stays_what_it_is_there():
    rho = density(altitude=np.array([120e3, 119_999.0, 0.0, -6e6]))
    assert np.all(rho == rho[0])
    assert density(altitude=121e3) < rho[0]


def test_seasons_sign_is_continuous_but_for_the_models_own_jump():
    # The sign of the asymmetric terms: northern summer, winter, a line between (Orekit has the same figures).
    table = COEFFICIENTS
    sign = dict(zip(range(1, 367), dtm2000.seasons(table, np.arange(1, 367))[:, 4, 1], strict=True))
    assert sign[1] == sign[58] == sign[285] == sign[366] == -1.0
    assert sign[100] == sign[180] == sign[243] == 1.0
    assert (sign[59], sign[79], sign[99]) == (-1.0, 0.0, 1.0)
    assert (sign[244], sign[264], sign[284]) == (1.0, 0.0, -1.0)
    # Only the temperature and its gradient at 120 km know the sign.
    signs = dtm2000.seasons(table, [1])[0, 4]
    assert signs[: len(dtm2000.QUANTITIES)].tolist() == [1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]


def test_local_time_is_counted_from_the_sun():
    model = force_model(8)
    values = np.empty(BODIES + model.bodies.shape[1])
    factors, scratch = np.empty((dtm2000.FACTORS, WIDTH)), np.empty((SCRATCH_ROWS, WIDTH))
    out = np.empty((2, WIDTH))
    t = 3 * DAY
    _density_at(t, np.ones((3, WIDTH)) * 7e6, model, values, factors, scratch, out)
    noon = np.arctan2(values[13], values[12])
    lon = noon + np.radians(15.0) * (np.arange(WIDTH) - 4)
    rows = np.ascontiguousarray(erfa.gd2gc(1, lon, np.full(WIDTH, 0.3), np.full(WIDTH, 4e5)).T)
    _density_at(t, rows, model, values, factors, scratch, out)
    day = 272 + 4 - 1  # 28 September 2016, a leap year's 272nd day, three days later at the same hour
    activity = model.activity[0, int((t - model.first) // model.step)]
    expected = density(
        day=day, altitude=4e5, lat=0.3, lon=lon, time=np.pi + lon - noon,
        f107=activity[0], mean=activity[1], kp=activity[2], kp_mean=activity[3],
    )  # fmt: skip
    # The activity drifts between the node and t by some 1e-5 of itself.
    np.testing.assert_allclose(out[1], expected, rtol=2e-5)
