"""Density of the thermosphere by DTM2000 (Bruinsma, Thuillier & Barlier 2003, JASTP 65, 1053-1070).

For each of nine quantities (exospheric temperature, temperature and its gradient at 120 km, six constituents)
the model is a sum over spherical harmonics of latitude, longitude and local time. Their factors depend on
date and activity, and are the same for every arc. So `reduce_to_date` computes them once, with the nine
quantities in the lanes of a row, and the kernel sums over the position alone. It leaves out what has no
coefficients: the harmonics of the longitude, and N.
"""

import math
from importlib import resources

import numpy as np

from opml.dynamics.kernels.lanes import WIDTH, compiled, exp, load, log, rows, select, splat, store

QUANTITIES = ("tt", "t0", "tp", "h", "he", "o", "n2", "o2", "n")
"""Names of the nine quantities in the file of coefficients."""

FLUX_COUPLED = rows(1)  # a row with 1 for each quantity whose periodic terms the solar flux scales, too
FLUX_COUPLED[0, : len(QUANTITIES)] = 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0

LATITUDE_TERMS = 9
"""Number of terms of the latitude: a constant, P10 to P60, and P20 and P40 about the magnetic pole."""

TESSERAL_TERMS = 20  # number of terms of the local time
_STEADY = 5  # after the terms of the flux
_ANNUAL = _STEADY + LATITUDE_TERMS
_DIURNAL = _ANNUAL + LATITUDE_TERMS
_SEMIDIURNAL = _DIURNAL + 8
_TERDIURNAL = _SEMIDIURNAL + 10
FACTORS = _DIURNAL + TESSERAL_TERMS
"""Number of rows of factors; the names above are the first rows of each kind of term."""

LOWEST_ALTITUDE = 120e3  # the model's lower boundary [m]

_POLAR_RADIUS_KM = 6356.77
_BASE_KM = 120.0
_GRAVITY_AT_GROUND = 980.665  # cm/s2
_GAS_CONSTANT = 831.4  # in the model's own units
_COSINE_POLE, _SINE_POLE = 0.19081, 0.98163  # magnetic pole, 79 N
_POLE_LONGITUDE_COSINE, _POLE_LONGITUDE_SINE = math.cos(-1.2392), math.sin(-1.2392)  # 71 W
_YEAR = 0.017214206  # 2 pi / 365 days, as the model rounds it
_WEIGHT = (1.0, 4.0, 16.0, 28.0, 32.0)
_MASS = (1.6606e-24, 6.6423e-24, 26.569e-24, 46.4958e-24, 53.1381e-24)  # g
_DIFFUSION = (-0.40, -0.38, 0.0, 0.0, 0.0)


def coefficients() -> np.ndarray:
    """Return the model's coefficients (97, WIDTH): rows from 1 as in the paper, columns as QUANTITIES."""
    text = resources.files("opml.data").joinpath("dtm2000.csv").read_text()
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    names = lines[0].split(",")
    a = rows(97)
    for line in lines[1:]:
        row = dict(zip(names, line.split(","), strict=True))
        a[int(row["index"]), : len(QUANTITIES)] = [float(row[name]) for name in QUANTITIES]
    return a


def seasons(a: np.ndarray, days_of_year: np.ndarray) -> np.ndarray:
    """Return the factors that depend on the day alone, for each day and quantity: (days, 5, WIDTH).

    a: from `coefficients`
    days_of_year: (days,) from 1

    They are annual and semi-annual cosines of the even and of the odd terms, and the sign of the terms that
    change with the hemisphere's season, which only the temperature profile at 120 km has.
    """
    days = np.asarray(days_of_year, float)[:, None]
    cosines = [
        np.cos(_YEAR * (days - a[11])),
        np.cos(2.0 * _YEAR * (days - a[14])),
        np.cos(_YEAR * (days - a[18])),
        np.cos(2.0 * _YEAR * (days - a[20])),
    ]
    sign = np.ones((len(days), WIDTH))
    sign[:, 1:3] = np.array([_season(day) for day in days_of_year])[:, None]
    return np.stack([*cosines, sign], axis=1)


def _season(day):
    """Return 1 in northern summer, -1 in winter, and a linear change between them."""
    if 99 < day < 244:
        return 1.0
    if day < 59 or day > 284:
        return -1.0
    return 1.0 - 2.0 * (day - 244) / 40.0 if day >= 100 else 2.0 * (day - 59) / 40.0 - 1.0


@compiled
def reduce_to_date(a, season, f107, f107_mean, kp_3h, kp_24h, factors):
    """Compute the factors of the position's terms from the date and the activity.

    a: from `coefficients`
    season: (5, WIDTH) of the day, from `seasons`
    f107, f107_mean: flux and its mean [sfu]
    kp_3h, kp_24h: Kp of 3 hours and its mean of 24 hours
    factors: (FACTORS, WIDTH) takes the factors
    """
    flux = _flux(a, f107 - f107_mean, f107_mean - 150.0)
    coupled = load(FLUX_COUPLED, 0)
    for n in range(_STEADY):
        store(factors, n, coupled * flux[n])
    odd, sign = load(season, 2), load(season, 4)
    _fold_steady(a, flux, sign, kp_3h, kp_24h, factors, _STEADY)
    _fold_annual(a, season, kp_3h, factors, _ANNUAL)
    _fold_diurnal(a, odd, kp_3h, factors, _DIURNAL)
    _fold_semidiurnal(a, odd, sign, factors, _SEMIDIURNAL)
    # Cosine, then sine of three times the local time, on P33.
    store(factors, _TERDIURNAL, load(a, 35))
    store(factors, _TERDIURNAL + 1, load(a, 36))


@compiled
def _flux(a, df, dm):
    """Return the factors of the constant and P10 to P40 by the solar flux.

    df: flux minus its mean [sfu]
    dm: mean flux minus 150 sfu [sfu]
    """
    return (
        load(a, 4) * df + load(a, 5) * df * df + load(a, 6) * dm + load(a, 69) * dm * dm,
        load(a, 82) * df,
        load(a, 83) * df + load(a, 85) * dm,
        load(a, 84) * df + load(a, 86) * dm,
        load(a, 87) * dm,
    )


@compiled
def _fold_steady(a, flux, sign, kp, km, factors, first):
    """Store the factors without a period, by latitude, flux and geomagnetic activity, from row `first` on."""
    activity = (
        (load(a, 7) * kp + load(a, 60) * kp**2 + load(a, 75) * kp**4)
        + load(a, 64) * km
        + load(a, 66) * km**2
        + load(a, 76) * km**4
    )
    store(factors, first, flux[0] + activity)
    store(factors, first + 1, flux[1] + sign * load(a, 74))
    store(factors, first + 2, flux[2] + load(a, 2))
    store(factors, first + 3, flux[3] + sign * load(a, 77))
    store(factors, first + 4, flux[4] + load(a, 3))
    store(factors, first + 5, sign * load(a, 78))
    store(factors, first + 6, load(a, 79))
    store(factors, first + 7, load(a, 8) * kp + load(a, 61) * kp**2 + load(a, 65) * km + load(a, 73) * km**2)
    store(factors, first + 8, load(a, 68) * kp + load(a, 72) * km)


@compiled
def _fold_annual(a, season, kp, factors, first):
    """Store the annual and semi-annual factors from row `first` on."""
    even, even2, odd, odd2 = load(season, 0), load(season, 1), load(season, 2), load(season, 3)
    store(factors, first, load(a, 9) * even + load(a, 12) * even2)
    store(factors, first + 1, load(a, 15) * odd + load(a, 19) * odd2 + load(a, 40) * odd * kp)
    store(factors, first + 2, load(a, 10) * even + load(a, 13) * even2)
    store(factors, first + 3, load(a, 16) * odd + load(a, 39) * odd2 + load(a, 41) * odd * kp)
    store(factors, first + 4, splat(0.0))
    store(factors, first + 5, load(a, 17) * odd + load(a, 59) * odd2 + load(a, 42) * odd * kp)
    store(factors, first + 6, splat(0.0))
    store(factors, first + 7, splat(0.0))
    store(factors, first + 8, splat(0.0))


@compiled
def _fold_diurnal(a, odd, kp, factors, first):
    """Store the factors of cosine, then sine of the local time on P11, P31, P51, P21 from row `first` on."""
    store(factors, first, load(a, 21) + load(a, 24) * odd + load(a, 43) * kp)
    store(factors, first + 1, load(a, 22) + load(a, 44) * kp)
    store(factors, first + 2, load(a, 23) + load(a, 45) * kp)
    store(factors, first + 3, load(a, 25) * odd)
    store(factors, first + 4, load(a, 26) + load(a, 29) * odd + load(a, 46) * kp)
    store(factors, first + 5, load(a, 27) + load(a, 47) * kp)
    store(factors, first + 6, load(a, 28) + load(a, 48) * kp)
    store(factors, first + 7, load(a, 30) * odd)


@compiled
def _fold_semidiurnal(a, odd, sign, factors, first):
    """Store the factors of cosine, then sine of twice the local time, from row `first` on.

    They belong to P22, P42, P32, P52, P62.
    """
    store(factors, first, load(a, 31))
    store(factors, first + 1, load(a, 37))
    store(factors, first + 2, load(a, 32) * odd + sign * load(a, 88))
    store(factors, first + 3, sign * load(a, 90))
    store(factors, first + 4, load(a, 92))
    store(factors, first + 5, load(a, 33))
    store(factors, first + 6, load(a, 38))
    store(factors, first + 7, load(a, 34) * odd + sign * load(a, 89))
    store(factors, first + 8, sign * load(a, 91))
    store(factors, first + 9, load(a, 93))


@compiled
def density(altitude, sin_lat, cos_lat, sin_lon, cos_lon, sin_time, cos_time, a, factors, basis):
    """Return the density [kg/m3]; below 120 km that at 120 km.

    altitude: geodetic [m]
    sin_time, cos_time: of the local solar time as an angle, 0 at midnight
    a: from `coefficients`
    factors: from `reduce_to_date`
    basis: LATITUDE_TERMS + TESSERAL_TERMS rows of scratch lanes
    """
    _fill_basis(sin_lat, cos_lat, sin_lon, cos_lon, sin_time, cos_time, basis)
    return density_again(altitude, a, factors, basis)


@compiled
def density_again(altitude, a, factors, basis):
    """Return the density [kg/m3] at the same places as before, by other factors.

    altitude, a, factors: as in `density`
    basis: as `density` filled it
    """
    g0, g1 = _two(0, factors, basis)
    g2, g3 = _two(2, factors, basis)
    g4, g5 = _two(4, factors, basis)
    g6, g7 = _two(6, factors, basis)
    t_inf = a[1, 0] * (1.0 + g0)
    t_120 = a[1, 1] + g1
    slope = a[1, 2] + g2
    z = select(altitude < LOWEST_ALTITUDE, splat(_BASE_KM), altitude * 1e-3)
    sigma = slope / (t_inf - t_120)
    height = sigma * ((z - _BASE_KM) * ((_POLAR_RADIUS_KM + _BASE_KM) / (_POLAR_RADIUS_KM + z)))
    t_z = t_inf - (t_inf - t_120) * exp(-height)
    cooling = log(t_120 / t_z)
    at_base = _GRAVITY_AT_GROUND / (1.0 + _BASE_KM / _POLAR_RADIUS_KM) ** 2
    gamma = (at_base / _GAS_CONSTANT) / (sigma * t_inf)
    total = splat(0.0)
    total = total + _constituent(0, a[1, 3], g3, gamma, cooling, height)
    total = total + _constituent(1, a[1, 4], g4, gamma, cooling, height)
    total = total + _constituent(2, a[1, 5], g5, gamma, cooling, height)
    total = total + _constituent(3, a[1, 6], g6, gamma, cooling, height)
    total = total + _constituent(4, a[1, 7], g7, gamma, cooling, height)
    return total * 1e3


@compiled
def _constituent(k, at_base, g, gamma, cooling, height):
    """Return the mass density [g/cm3] of constituent `k`, in diffusive equilibrium above 120 km."""
    gamma = _WEIGHT[k] * gamma
    return (_MASS[k] * at_base) * exp(g + (1.0 + _DIFFUSION[k] + gamma) * cooling - height * gamma)


@compiled
def _fill_basis(c, s, sin_lon, cos_lon, sh, ch, basis):
    """Store latitude terms, then tesseral terms, row by row; c, s: sine and cosine of the latitude."""
    _fill_zonal(c, s, sin_lon, cos_lon, basis)
    _fill_tesseral(c, s, sh, ch, basis, LATITUDE_TERMS)


@compiled
def _fill_zonal(c, s, sin_lon, cos_lon, basis):
    """Store the constant, P10 to P60, and P20 and P40 about the magnetic pole."""
    c2 = c * c
    c4 = c2 * c2
    p40 = 4.375 * c4 - 3.75 * c2 + 0.375
    p50 = c * (7.875 * c4 - 8.75 * c2 + 1.875)
    to_pole = cos_lon * _POLE_LONGITUDE_COSINE + sin_lon * _POLE_LONGITUDE_SINE
    magnetic = s * _COSINE_POLE * to_pole + c * _SINE_POLE
    magnetic2 = magnetic * magnetic
    store(basis, 0, splat(1.0))
    store(basis, 1, c)
    store(basis, 2, 1.5 * c2 - 0.5)
    store(basis, 3, c * (2.5 * c2 - 1.5))
    store(basis, 4, p40)
    store(basis, 5, p50)
    store(basis, 6, (5.5 * c * p50 - 2.5 * p40) * (1.0 / 3.0))
    store(basis, 7, 1.5 * magnetic2 - 0.5)
    store(basis, 8, 4.375 * magnetic2 * magnetic2 - 3.75 * magnetic2 + 0.375)


@compiled
def _fill_tesseral(c, s, sh, ch, basis, first):
    """Store the terms of the local time, once, twice and three times."""
    c2, s2 = c * c, s * s
    c4 = c2 * c2
    p21 = 3.0 * c * s
    p31 = s * (7.5 * c2 - 1.5)
    p51 = s * (39.375 * c4 - 26.25 * c2 + 1.875)
    p22 = 3.0 * s2
    p32 = 15.0 * c * s2
    p42 = s2 * (52.5 * c2 - 7.5)
    p52 = 3.0 * c * p42 - 2.0 * p32
    p62 = 2.75 * c * p52 - 1.75 * p42
    p33 = 15.0 * s * s2
    c2h, s2h = ch * ch - sh * sh, 2.0 * ch * sh
    c3h, s3h = c2h * ch - s2h * sh, s2h * ch + c2h * sh
    _store_four(s, p31, p51, p21, ch, basis, first)
    _store_four(s, p31, p51, p21, sh, basis, first + 4)
    _store_five(p22, p42, p32, p52, p62, c2h, basis, first + 8)
    _store_five(p22, p42, p32, p52, p62, s2h, basis, first + 13)
    store(basis, first + 18, p33 * c3h)
    store(basis, first + 19, p33 * s3h)


@compiled
def _store_four(p, q, r, s, factor, basis, first):
    store(basis, first, p * factor)
    store(basis, first + 1, q * factor)
    store(basis, first + 2, r * factor)
    store(basis, first + 3, s * factor)


@compiled
def _store_five(p, q, r, s, t, factor, basis, first):
    _store_four(p, q, r, s, factor, basis, first)
    store(basis, first + 4, t * factor)


@compiled
def _two(k, factors, basis):
    """Return the quantities k and k + 1: constant terms plus periodic terms scaled by the flux.

    Sums of two have their lanes in registers, those of all have not.
    """
    f0, f1 = _sums(k, factors, 0, _STEADY, basis)
    c0, c1 = _sums(k, factors, _STEADY, LATITUDE_TERMS, basis)
    p0, p1 = _sums(k, factors, _ANNUAL, LATITUDE_TERMS + TESSERAL_TERMS, basis)
    return c0 + p0 * (1.0 + f0), c1 + p1 * (1.0 + f1)


@compiled
def _sums(k, factors, row, count, basis):
    """Return the sums of the quantities k and k + 1 over the first `count` rows of the basis."""
    s0, s1 = splat(0.0), splat(0.0)
    for n in range(count):
        b = load(basis, n)
        s0 = s0 + factors[row + n, k] * b
        s1 = s1 + factors[row + n, k + 1] * b
    return s0, s1
