"""Tides of the solid Earth: what Moon and Sun change of the gravity field's coefficients.

Source: IERS Conventions 2010 (Technical Note 36), sec. 6.2.1: step 1, in which each degree and order answers
to the attraction by one Love number (eq. 6.6, 6.7), and step 2, the corrections for each frequency (eq. 6.8).
"""

from importlib import resources
from io import StringIO

import erfa
import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import EARTH_RATE
from opml.dynamics.frames import gcrf_to_itrf
from opml.dynamics.kernels.tides import COLUMNS, TERMS
from opml.dynamics.run_environment import Environment
from opml.environment.gravity_field import ZERO_TIDE, check_tide_system

RAISED_BY = ("moon", "sun")  # bodies that raise tides, whether or not they pull at the RSO

_LOVE = {
    (2, 0): 0.30190,
    (2, 1): 0.29830 - 0.00144j,
    (2, 2): 0.30102 - 0.00130j,
    (3, 0): 0.093,
    (3, 1): 0.093,
    (3, 2): 0.093,
    (3, 3): 0.094,
}
"""Love numbers k_nm of an anelastic Earth (table 6.3)."""

_LOVE_PLUS = {(2, 0): -0.00089, (2, 1): -0.00080, (2, 2): -0.00057}
"""Love numbers k_2m(+), of the tide of degree 4 that the attraction of degree 2 raises (table 6.3)."""

_PERMANENT = 4.4228e-8 * -0.31460 * 0.30190
"""The part of the tide in C20 that never ends (sec. 6.2.2); a zero-tide field holds it already."""

_UNIT = 1e-12  # of the amplitudes in the table of corrections

_DAYS_PER_CENTURY = 36525.0
_J2000 = 2451545.0


def nodes(environment: Environment) -> np.ndarray:
    """Return changes of fully normalised coefficients (nodes, COLUMNS), as kernels.tides reads them.

    environment: its tables of Earth orientation and ephemerides have the same nodes

    They are those in a frame that does not turn with the Earth, where only the Moon's motion changes them,
    so that hourly nodes will do. Raises InputError for a field that they cannot be added to.
    """
    check_tide_system(environment.tide_system)
    earth_orientation = environment.earth_orientation
    t = earth_orientation["t"].to_numpy()
    changes = dict.fromkeys(TERMS, np.zeros(len(t), complex))
    for body in RAISED_BY:
        positions = environment.ephemerides[[f"{body}_{axis}" for axis in "xyz"]].to_numpy()
        mass = environment.gms[body] / environment.gm
        places = np.einsum("nij,nj->in", gcrf_to_itrf(earth_orientation, t), positions)
        for term, change in _equilibrium(places, mass, environment.radius).items():
            changes[term] = changes[term] + change
    angle = earth_orientation["era_offset"].to_numpy() + EARTH_RATE * t
    out = np.zeros((len(t), COLUMNS))
    corrections = _corrections(environment.epoch, t)
    for k, (n, m) in enumerate(TERMS):
        still = changes[n, m] * np.exp(-1j * m * angle)
        if n == 2:
            still = still + corrections[m]
        out[:, 2 * k], out[:, 2 * k + 1] = still.real, -still.imag
    if environment.tide_system == ZERO_TIDE:
        out[:, 2 * TERMS.index((2, 0))] -= _PERMANENT
    return out


def _equilibrium(places: np.ndarray, mass: float, radius: float) -> dict[tuple[int, int], np.ndarray]:
    """Return C - iS (nodes,) by degree and order, of one body by one Love number each (eq. 6.6, 6.7).

    places: (3, nodes) of the body in ITRF [m]
    mass: of the body, relative to the Earth's
    radius: of the field [m]
    """
    r = np.linalg.norm(places, axis=0)
    harmonics = _harmonics(*(places / r))
    coefficients = {
        (n, m): love / (2 * n + 1) * mass * (radius / r) ** (n + 1) * harmonics[n, m]
        for (n, m), love in _LOVE.items()
    }
    for (_, m), love in _LOVE_PLUS.items():
        coefficients[4, m] = love / 5.0 * mass * (radius / r) ** 3 * harmonics[2, m]
    return coefficients


def _harmonics(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> dict[tuple[int, int], np.ndarray]:
    """Return P_nm(sin latitude) exp(-i m longitude), fully normalised, of a direction in ITRF."""
    west = x - 1j * y
    return {
        (2, 0): np.sqrt(5.0) * (3.0 * z**2 - 1.0) / 2.0,
        (2, 1): np.sqrt(5.0 / 3.0) * 3.0 * z * west,
        (2, 2): np.sqrt(5.0 / 12.0) * 3.0 * west**2,
        (3, 0): np.sqrt(7.0) * (5.0 * z**3 - 3.0 * z) / 2.0,
        (3, 1): np.sqrt(7.0 / 6.0) * 1.5 * (5.0 * z**2 - 1.0) * west,
        (3, 2): np.sqrt(7.0 / 60.0) * 15.0 * z * west**2,
        (3, 3): np.sqrt(7.0 / 360.0) * 15.0 * west**3,
    }


def _corrections(epoch: str, t: np.ndarray) -> list[np.ndarray]:
    """Return C_2m - iS_2m (nodes,) of orders 0 to 2 by the frequencies, in a frame that does not turn."""
    text = resources.files("opml.data").joinpath("solid_tides.csv").read_text(encoding="ascii")
    table = pd.read_csv(StringIO(text), comment="#")
    tt = epochs.tt(epoch, t)
    # The series are of TDB; TT in its place changes no angle by more than 1e-8 rad.
    centuries = ((tt[0] - _J2000) + tt[1]) / _DAYS_PER_CENTURY
    delaunay = [
        argument(centuries) for argument in (erfa.fal03, erfa.falp03, erfa.faf03, erfa.fad03, erfa.faom03)
    ]
    # Sidereal time less the angle of the Earth's rotation, which is the same at any universal time.
    sidereal = erfa.gmst06(*tt, *tt) - erfa.era00(*tt)
    coefficients = []
    for m, answer in enumerate((1.0, -1j, 1.0)):
        rows = table[table["order"] == m]
        multipliers = rows[["l", "l_prime", "f", "d", "omega"]].to_numpy()
        amplitudes = _UNIT * (rows["in_phase"].to_numpy() + 1j * rows["out_of_phase"].to_numpy())
        phases = m * (sidereal + np.pi) - multipliers @ np.array(delaunay)
        coefficients.append(answer * (amplitudes @ np.exp(1j * phases)))
    return [coefficients[0].real, *coefficients[1:]]
