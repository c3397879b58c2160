"""Tides in the gravity field: coefficients that change with time, in the weights that `gravity` reads.

The weights are linear in the coefficients. So a tide is added to the few of them that it reaches, once for
all lanes whenever the surroundings are looked up, and gravity takes no longer than without tides.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from opml.dynamics.kernels.gravity import PARTS, row, weights
from opml.dynamics.kernels.lanes import compiled

DEGREE, ORDER = 4, 3  # highest degree and order of a coefficient with a tide

TERMS = ((2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2), (3, 3), (4, 0), (4, 1), (4, 2))
"""Degree and order of each pair of coefficients with a tide."""

ORDERS = np.array([m for _, m in TERMS])

COLUMNS = 2 * len(TERMS)  # numbers of a tide: cosine and sine coefficient of each pair


class Tides(NamedTuple):
    """Tides of a force model, and what they do to its weights; no nodes: no tides."""

    nodes: np.ndarray  # (nodes, COLUMNS) changes of coefficients, in a frame without the Earth's rotation
    places: np.ndarray  # (places, 2): row and column of each weight that a tide changes
    columns: np.ndarray  # (places, 2): the numbers of a tide that change it
    factors: np.ndarray  # (places, 2): how much
    still: np.ndarray  # the weights without tides

    def of_rows(self, rows: Sequence[int], still: np.ndarray) -> "Tides":
        """Return the tides of a part of the weights: these rows, ascending, with all that tides change."""
        if not len(self.nodes):
            return self
        places = np.column_stack([np.searchsorted(rows, self.places[:, 0]), self.places[:, 1]])
        return self._replace(places=places, still=still)


def tides(nodes: np.ndarray, still: np.ndarray, degree: int) -> Tides:
    """Return the tides of a field.

    nodes: (nodes, COLUMNS) as in Tides
    still: the weights of the field without tides, of at least DEGREE and ORDER
    degree: of the field
    """
    # One order above and one below change a weight of x and y; one order alone changes that of z.
    effects: defaultdict[tuple[int, int], list[tuple[int, float]]] = defaultdict(list)
    for k, (n, m) in enumerate(TERMS):
        # There is no sine coefficient of order 0.
        for part in (0, 1) if m > 0 else (0,):
            for place, factor in _effects(n, m, part, degree):
                effects[place].append((2 * k + part, factor))
    pairs = np.array([[*constituents, (0, 0.0)][:2] for constituents in effects.values()])
    return Tides(nodes, np.array(list(effects)), pairs[..., 0].astype(np.int64), pairs[..., 1].copy(), still)


def no_tides() -> Tides:
    """Return the tides of a rigid Earth."""
    empty = np.empty((0, 2), np.int64)
    return Tides(np.empty((0, COLUMNS)), empty, empty, np.empty((0, 2)), np.empty((0, PARTS)))


def _effects(n: int, m: int, part: int, degree: int) -> list[tuple[tuple[int, int], float]]:
    """Return places in the weights of a field of some degree, and their change with one coefficient."""
    unit = np.zeros((2, DEGREE + 1, ORDER + 1))
    unit[part, n, m] = 1.0
    small = weights(*unit)
    constituents = []
    for order in range(ORDER + 2):
        for harmonic in range(order, DEGREE + 2):
            change = small[row(harmonic, order, DEGREE)]
            # The first weight is the recursion's, which is the same for all fields.
            constituents += [
                ((row(harmonic, order, degree), k), change[k]) for k in range(1, PARTS) if change[k] != 0.0
            ]
    return constituents


@compiled
def turn(values: np.ndarray, first: int, angle: float) -> None:
    """Turn coefficients with the Earth.

    values: those in a frame without its rotation from index `first` on, COLUMNS of them; takes those in ITRF
    angle: of the rotation [rad]
    """
    c1, s1 = math.cos(angle), math.sin(angle)
    c2, s2 = c1 * c1 - s1 * s1, 2.0 * s1 * c1
    cosines, sines = (1.0, c1, c2, c1 * c2 - s1 * s2), (0.0, s1, s2, s1 * c2 + c1 * s2)
    for k in range(len(ORDERS)):
        cosine, sine = cosines[ORDERS[k]], sines[ORDERS[k]]
        c, s = values[first + 2 * k], values[first + 2 * k + 1]
        values[first + 2 * k] = c * cosine + s * sine
        values[first + 2 * k + 1] = s * cosine - c * sine


@compiled
def add(values: np.ndarray, first: int, tides: Tides, weights: np.ndarray) -> None:
    """Write the weights with tides.

    values: changes of the coefficients from index `first` on
    """
    for k in range(tides.places.shape[0]):
        r, part = tides.places[k, 0], tides.places[k, 1]
        weights[r, part] = tides.still[r, part] + (
            tides.factors[k, 0] * values[first + tides.columns[k, 0]]
            + tides.factors[k, 1] * values[first + tides.columns[k, 1]]
        )
