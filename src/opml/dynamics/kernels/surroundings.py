"""Surroundings of all arcs at a time: the Earth's rotation, Sun, Moon, planets and the thermosphere.

They depend on time alone. So they are interpolated between the uniform nodes of the force model once per
stage of the integrator, and the lanes share them.
"""

import math
from typing import NamedTuple

import numpy as np

from opml.base.constants import DAY, EARTH_RATE
from opml.dynamics.kernels import tides
from opml.dynamics.kernels.dtm2000 import FACTORS, reduce_to_date
from opml.dynamics.kernels.gravity import row
from opml.dynamics.kernels.lanes import compiled, rows
from opml.dynamics.kernels.tides import Tides

ROTATION, SPIN, SUN_ITRF, TIDE = 0, 9, 12, 15
BODIES = TIDE + tides.COLUMNS
"""First indices of the parts of the values.

The tide is zero where the force model has none. Behind the bodies are the columns of added forces.
"""

AXIS = ROTATION + 6  # first index of the Earth's axis in GCRF: the last row of the rotation
_ASIDE = 5e-4  # distance [s] from a jump at which steps end, so that each step sees one side of it only

_SixWeights = tuple[float, float, float, float, float, float]


class ForceModel(NamedTuple):
    """A force model in arrays and numbers, for the kernels; `forces.build` makes it."""

    first: float  # time of the first node [s since the epoch]
    step: float  # between nodes [s]
    orientation: np.ndarray  # (nodes, 6): CIP x and y, CIO locator, pole x and y, ERA offset [rad]
    spin: np.ndarray  # (nodes, 3): the Earth's rotation vector in GCRF [rad/s]
    added: np.ndarray  # (forces,): first column of each of added_forces.FORCES, or OFF
    columns_of_added: np.ndarray  # (nodes, columns): what added forces need of time
    bodies: np.ndarray  # (nodes, 3 count): geocentric GCRF positions [m], the Sun first
    gms: np.ndarray  # (count,) [m3/s2], 0 where a body's pull is not in the model
    activity: np.ndarray  # (kinds, nodes, 4): F10.7, its mean [sfu], Kp of 3 h and 24 h; one but in a block
    flown: np.ndarray  # (kinds,): whether the density is needed under that activity; a block's own
    midnight: float  # start of the epoch's UTC day [s since the epoch]
    seasons: np.ndarray  # (days, 5, WIDTH), from dtm2000.seasons
    thermosphere: np.ndarray  # (97, WIDTH), from dtm2000.coefficients
    weights: np.ndarray  # (terms, 7), from gravity.weights
    tides: Tides  # of the weights
    columns: int  # orders in the weights
    degree: int  # highest degree of a harmonic in the weights
    gm: float  # of the Earth, as the field gives it [m3/s2]
    radius: float  # of the field [m]
    issued: np.ndarray  # (outlooks,) times of issue of the outlooks, ascending [s]; none: activity is for all
    known: np.ndarray  # (outlooks,) number of the nodes up to each issue: there `activity` holds
    outlooks: np.ndarray  # (outlooks, width, 4): activity as forecast at each issue, at the nodes after these

    def jumps(self, begin: float, end: float) -> np.ndarray:
        """Return the times between two times [s] on both sides of each midnight.

        DTM2000's day of the year, and so its density, jumps there.
        """
        low, high = min(begin, end), max(begin, end)
        days = np.arange(np.ceil((low - self.midnight) / DAY), np.floor((high - self.midnight) / DAY) + 1.0)
        around = self.midnight + np.add.outer(days * DAY, [-_ASIDE, _ASIDE]).ravel()
        return around[(around > low) & (around < high)]

    def newest_outlook(self, t: np.ndarray) -> np.ndarray:
        """Return the index of the newest outlook at times t [s], -1 before the first issue."""
        return np.searchsorted(self.issued, t, side="right") - 1

    def known_at(self, t: float) -> "ForceModel":
        """Return the model under what is known at a time [s], whenever an arc begins."""
        newest = int(self.newest_outlook(np.array(t)))
        day = slice(max(newest, 0), newest + 1)
        known, outlooks = self.known[day], self.outlooks[day]
        return self._replace(issued=np.full(len(outlooks), -np.inf), known=known, outlooks=outlooks)

    def truncated(self, degree: int) -> "ForceModel":
        """Return the model with its field to a degree and order above any tide; itself if it has no more."""
        if self.degree - 1 <= degree:
            return self
        columns = min(self.columns, degree + 2)
        # Harmonics of one degree more stand in the weights, as in the acceleration.
        kept = [row(n, m, self.degree - 1) for m in range(columns) for n in range(m, degree + 2)]
        weights = np.ascontiguousarray(self.weights[kept])
        return self._replace(
            weights=weights, columns=columns, degree=degree + 1, tides=self.tides.of_rows(kept, weights)
        )

    def without_tides(self) -> "ForceModel":
        """Return the model of a rigid Earth."""
        return self._replace(tides=tides.no_tides())

    def for_block(self, outlooks: np.ndarray) -> "ForceModel":
        """Return the model with the activity of each of these outlooks, the model's own for -1.

        Where tides change the weights with each `look_up`, they are the block's own.
        """
        activity = np.stack([self._under(one) if one >= 0 else self.activity[0] for one in outlooks])
        weights = self.weights.copy() if len(self.tides.nodes) else self.weights
        return self._replace(activity=activity, flown=np.ones(len(activity), np.bool_), weights=weights)

    def _under(self, outlook: int) -> np.ndarray:
        """Return the activity (nodes, 4) of an outlook, not finite beyond its forecast."""
        begin, activity = self.known[outlook], np.full(self.activity.shape[1:], np.nan)
        ahead = activity[begin:][: self.outlooks.shape[1]]
        activity[:begin] = self.activity[0, :begin]
        ahead[:] = self.outlooks[outlook, : len(ahead)]
        return activity


def allocate(model: ForceModel) -> tuple[np.ndarray, np.ndarray]:
    """Return empty values and factors for `look_up` to fill."""
    columns = model.bodies.shape[1] + model.columns_of_added.shape[1]
    return np.zeros(BODIES + columns), rows(FACTORS * len(model.activity))


@compiled
def look_up(t: float, model: ForceModel, values: np.ndarray, factors: np.ndarray) -> None:
    """Fill `values` and DTM2000's `factors` at time t [s], and add the tides to the weights of the model.

    The values are rotation, spin, Sun, tide, bodies and the columns of added forces.
    """
    node, u = _locate(t, model.first, model.step, model.orientation.shape[0])
    w = _weights(u)
    for k in range(model.bodies.shape[1]):
        values[BODIES + k] = _between(model.bodies, node, k, w)
    for k in range(3):
        values[SPIN + k] = _between(model.spin, node, k, w)
    orient(t, model.first, model.step, model.orientation, values)
    for k in range(model.columns_of_added.shape[1]):
        values[BODIES + model.bodies.shape[1] + k] = _between(model.columns_of_added, node, k, w)
    if model.tides.nodes.shape[0] > 0:
        for k in range(tides.COLUMNS):
            values[TIDE + k] = _between(model.tides.nodes, node, k, w)
        tides.turn(values, TIDE, _between(model.orientation, node, 5, w) + EARTH_RATE * t)
        tides.add(values, TIDE, model.tides, model.weights)
    sx, sy, sz = values[BODIES], values[BODIES + 1], values[BODIES + 2]
    for k in range(3):
        values[SUN_ITRF + k] = values[3 * k] * sx + values[3 * k + 1] * sy + values[3 * k + 2] * sz
    day = min(max(math.floor((t - model.midnight) / DAY), 0), model.seasons.shape[0] - 1)
    for kind, activity in enumerate(model.activity):
        if model.flown[kind]:
            reduce_to_date(
                model.thermosphere,
                model.seasons[day],
                _linear(activity, node, 0, u),
                _linear(activity, node, 1, u),
                _linear(activity, node, 2, u),
                _linear(activity, node, 3, u),
                factors[FACTORS * kind : FACTORS * (kind + 1)],
            )


@compiled
def orient(t: float, first: float, step: float, orientation: np.ndarray, values: np.ndarray) -> None:
    """Fill the rotation in `values` at time t [s].

    first, step: of the nodes [s]
    orientation: (nodes, 6) as in ForceModel
    """
    node, u = _locate(t, first, step, orientation.shape[0])
    w = _weights(u)
    earth_rotation(
        _between(orientation, node, 0, w),
        _between(orientation, node, 1, w),
        _between(orientation, node, 2, w),
        _between(orientation, node, 3, w),
        _between(orientation, node, 4, w),
        _between(orientation, node, 5, w) + EARTH_RATE * t,
        values,
    )


@compiled
def sun(t: float, model: ForceModel) -> tuple[float, float, float]:
    """Return the Sun's geocentric position in GCRF [m] at time t [s]."""
    node, u = _locate(t, model.first, model.step, model.bodies.shape[0])
    w = _weights(u)
    return (
        _between(model.bodies, node, 0, w),
        _between(model.bodies, node, 1, w),
        _between(model.bodies, node, 2, w),
    )


@compiled
def _locate(t: float, first: float, step: float, nodes: int) -> tuple[int, float]:
    """Return the node before t, moved to have two nodes before it and three after it, and the steps since."""
    where = (t - first) / step
    node = min(max(math.floor(where), 2), nodes - 4)
    return node, where - node


@compiled
def _weights(u: float) -> _SixWeights:
    """Return the weights of Lagrange's polynomial at u through nodes at -2 to 3.

    Hourly nodes give the Moon to 10 micrometres.
    """
    a, b, c, d, e, f = u + 2.0, u + 1.0, u, u - 1.0, u - 2.0, u - 3.0
    return (
        -b * c * d * e * f / 120.0,
        a * c * d * e * f / 24.0,
        -a * b * d * e * f / 12.0,
        a * b * c * e * f / 12.0,
        -a * b * c * d * f / 24.0,
        a * b * c * d * e / 120.0,
    )


@compiled
def _between(nodes: np.ndarray, node: int, column: int, w: _SixWeights) -> float:
    return (
        w[0] * nodes[node - 2, column]
        + w[1] * nodes[node - 1, column]
        + w[2] * nodes[node, column]
        + w[3] * nodes[node + 1, column]
        + w[4] * nodes[node + 2, column]
        + w[5] * nodes[node + 3, column]
    )


@compiled
def _linear(nodes: np.ndarray, node: int, column: int, u: float) -> float:
    return nodes[node, column] + u * (nodes[node + 1, column] - nodes[node, column])


@compiled
def earth_rotation(
    x: float, y: float, s: float, x_pole: float, y_pole: float, angle: float, values: np.ndarray
) -> None:
    """Write the rotation from GCRF to ITRF into values[0:9], row by row.

    x, y: CIP in GCRF [rad]
    s: CIO locator [rad]
    x_pole, y_pole: polar motion [rad]
    angle: Earth rotation angle [rad]

    Source: IERS Conventions 2010, sec. 5.4.4, 5.4.1. The TIO locator s', 5e-11 rad in 2017, is left out.
    """
    z = math.sqrt(1.0 - x * x - y * y)
    a = 1.0 / (1.0 + z)
    cs, sn = math.cos(angle - s), math.sin(angle - s)
    # Celestial motion of the pole; the rotation by s is part of that by the Earth rotation angle.
    q00, q01, q02 = 1.0 - a * x * x, -a * x * y, -x
    q11, q12 = 1.0 - a * y * y, -y
    r00, r01, r02 = cs * q00 + sn * q01, cs * q01 + sn * q11, cs * q02 + sn * q12
    r10, r11, r12 = -sn * q00 + cs * q01, -sn * q01 + cs * q11, -sn * q02 + cs * q12
    r20, r21, r22 = x, y, z
    # Polar motion: R1(-y_pole) after R2(-x_pole).
    cx, sx, cy, sy = math.cos(x_pole), math.sin(x_pole), math.cos(y_pole), math.sin(y_pole)
    w00, w02 = cx, sx
    w10, w11, w12 = sx * sy, cy, -cx * sy
    w20, w21, w22 = -sx * cy, sy, cx * cy
    values[0], values[1], values[2] = w00 * r00 + w02 * r20, w00 * r01 + w02 * r21, w00 * r02 + w02 * r22
    values[3], values[4], values[5] = (
        w10 * r00 + w11 * r10 + w12 * r20,
        w10 * r01 + w11 * r11 + w12 * r21,
        w10 * r02 + w11 * r12 + w12 * r22,
    )
    values[6], values[7], values[8] = (
        w20 * r00 + w21 * r10 + w22 * r20,
        w20 * r01 + w21 * r11 + w22 * r21,
        w20 * r02 + w21 * r12 + w22 * r22,
    )
