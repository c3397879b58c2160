"""The orbits inside the sets of an object's last weeks: the span over which they agree, and how far they
erred.

No truth is needed to find the span over which a publisher fits. Taken over the right one, the orbits of two
sets of different days agree across the track to metres; over another they are off by what SGP4 lacks. The
same orbits give the error of each at later sets: the errors that its next one will have.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.element_sets.inside.orbit_inside import EVERY, LIGHT_STEP, Equations, NearbyOrbit, solve
from opml.orbits.elements import bent_rsw, positions_beside


@dataclass(frozen=True)
class FitSpan:
    """Time before and after the epoch of a set that its publisher fitted SGP4 over [s]."""

    before: float
    after: float

    @property
    def is_centred(self) -> bool:
        """Whether the span is as long after the epoch as before it, as of sets with an orbit inside."""
        return self.before == self.after


def centred(half: float) -> FitSpan:
    """Return a span of so long on both sides [s]."""
    return FitSpan(half, half)


SPANS = (
    *(centred(HOUR * hours) for hours in (24, 36, 48, 60, 72, 96, 120, 144, 168, 192)),
    *(FitSpan(HOUR * hours, 0.0) for hours in (72, 120, 168)),
)
"""Spans that are tried: centred ones, and those before the epoch that fits of another kind are near to."""

LONGEST = 192.0 * HOUR  # half of the longest span that is tried [s]
REACH = 8.0 * DAY  # longest time between two sets that are compared [s]

ERRORS = [*("i", "j", "days", "r", "s", "w", "ahead"), *("sgp4_r", "sgp4_s", "sgp4_w", "sgp4_ahead")]
"""Columns of `PastOrbits.errors`."""

_APART = 4.0 * DAY  # least time between two sets that tell whether a span is right [s]
_FEWEST = 3  # pairs of sets that tell a span
_UNLIKELY = 1.5  # by what orbits over a span before the epochs have to agree better than over others
_INDEPENDENT, _AGREED = 4.0, 10.0  # pairs that count each for itself, and what they agree to [m]
GUESSED_LIGHT = 0.01  # standard deviation of Cr A/m of who knows nothing of a body [m2/kg]
_AROUND = np.arange(-3, 4)  # points about the epoch of a later set: nearly two revolutions of a low orbit
ABOUT = EVERY * 4.0  # time after that epoch up to which orbits are compared [s]


@dataclass(frozen=True, eq=False)
class PastOrbits:
    """Orbits inside the sets of an object, a set a day at most, in the order of their epochs.

    t: (n,) epochs of the sets [s]
    """

    t: np.ndarray
    orbits: Sequence[NearbyOrbit]
    equations: Sequence[Equations]  # of each set on its own orbit

    def numbers(self, span: FitSpan, sunlight: float = 0.0) -> np.ndarray:
        """Return the changes (n, 8) of the numbers of the orbits that solve the sets' equations over a span.

        sunlight: as of `orbit_inside.solve`
        """
        return np.array(
            [
                solve(orbit, [equations.over(t - span.before, t + span.after)], sunlight=sunlight)
                for t, orbit, equations in zip(self.t, self.orbits, self.equations, strict=True)
            ]
        )

    def errors(self, numbers: np.ndarray) -> pd.DataFrame:
        """Return how far orbits are off those of later sets at their epochs: a row a pair of sets.

        numbers: of `numbers`

        Columns: i, j (sets), days (from the epoch of i to that of j), r, s, w (root mean squares over a
        revolution or two [m]), ahead (mean along the track [m]), and the same of SGP4 from set i, sgp4_r to
        sgp4_ahead.
        """
        i, j = self._pairs
        off = self._off(numbers)
        parts = zip(("", "sgp4_"), (off, self._by_sgp4 - self._changes(numbers) + off), strict=True)
        columns = {"i": i, "j": j, "days": (self.t[j] - self.t[i]) / DAY}
        for name, errors in parts:
            sizes = np.sqrt(self._means(errors**2))
            columns |= {f"{name}{axis}": sizes[:, k] for k, axis in enumerate("rsw")}
            columns[f"{name}ahead"] = self._means(errors)[:, 1]
        return pd.DataFrame(columns, columns=ERRORS, dtype=float)

    def sunlight(self, span: FitSpan) -> float:
        """Return the step of Cr A/m over which orbits of a span agree best outwards: it shifts their
        perigees.

        Pairs of sets count as _INDEPENDENT ones, and the number first taken as one more, off by
        GUESSED_LIGHT.
        """
        i, j = self._pairs
        apart = self.t[j] - self.t[i] >= _APART
        _, there = self._points
        counted = there & apart[:, None]
        dark, lit = (self._off(self.numbers(span, step))[counted][:, 0] for step in (0.0, 1.0))
        if apart.sum() < _FEWEST:
            return 0.0
        change = lit - dark
        weight = _INDEPENDENT / (_AGREED**2 * len(dark))
        guess = (LIGHT_STEP / GUESSED_LIGHT) ** 2
        return float(-weight * (dark @ change) / (weight * (change @ change) + guess))

    @cached_property
    def _pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """Sets i and j (pairs,) that are at most REACH apart, j the later."""
        later, earlier = np.tril_indices(len(self.t), -1)
        near = self.t[later] - self.t[earlier] <= REACH
        return earlier[near], later[near]

    @cached_property
    def _points(self) -> tuple[np.ndarray, np.ndarray]:
        """Points (pairs, points) of the orbits of i about the epoch of j, and whether they are there."""
        i, j = self._pairs
        return _places(self.orbits, i, self.t[j])

    @cached_property
    def _own(self) -> tuple[np.ndarray, np.ndarray]:
        """States (pairs, points, 6) and partials (pairs, points, 3, 8) of the orbits of i at these points."""
        return self._at(self._pairs[0], self._points[0])

    @cached_property
    def _by_sgp4(self) -> np.ndarray:
        """By what SGP4 from set i is off its orbit at these points (pairs, points, 3)."""
        by_sgp4 = [orbit.displacements(orbit.beginning.satellite) for orbit in self.orbits]
        return _gathered(by_sgp4, self._pairs[0], self._points[0])

    @cached_property
    def _judges(self) -> tuple[np.ndarray, np.ndarray]:
        """States and partials of the orbits of j about its epoch."""
        _, j = self._pairs
        places, _ = _places(self.orbits, j, self.t[j])
        return self._at(j, places)

    def _at(self, sets: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return states and partials of the orbits of sets (n,) at places (n, points)."""
        states, partials = (
            [getattr(orbit, name) for orbit in self.orbits] for name in ("states", "partials")
        )
        return _gathered(states, sets, places), _gathered(partials, sets, places)

    def _changes(self, numbers: np.ndarray) -> np.ndarray:
        """Return by what the orbits of i change (pairs, points, 3) with numbers of all sets (sets, 8)."""
        i, _ = self._pairs
        _, partials = self._own
        return np.einsum("pkan,pn->pka", partials, numbers[i])

    def _off(self, numbers: np.ndarray) -> np.ndarray:
        """Return what the orbits of i are off those of j (pairs, points, 3) [m]; numbers: (sets, 8)."""
        _, j = self._pairs
        states, partials = self._judges
        bent = np.einsum("pkan,pn->pka", partials, numbers[j])
        judges = np.concatenate([positions_beside(states, bent), states[..., 3:]], axis=2)
        own, _ = self._own
        positions = positions_beside(own, self._changes(numbers))
        return bent_rsw(positions.reshape(-1, 3), judges.reshape(-1, 6)).reshape(positions.shape)

    def _means(self, values: np.ndarray) -> np.ndarray:
        """Return the means (pairs, 3) of values (pairs, points, 3) over the points that are there."""
        _, there = self._points
        return np.asarray(np.where(there[..., None], values, 0.0).sum(axis=1) / there.sum(axis=1)[:, None])


def _gathered(parts: Sequence[np.ndarray], sets: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return rows of the parts of sets (n,) at places (n, points)."""
    rows = [parts[k][at] for k, at in zip(sets, places, strict=True)]
    return np.reshape(rows, (*places.shape, *parts[0].shape[1:]))


def _places(orbits: Sequence[NearbyOrbit], sets: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points (n, points) of orbits of sets (n,) about times (n,), and whether they are there."""
    begins, counts = (np.array([call(orbits[k].t) for k in sets]) for call in (np.min, len))
    places = np.round((t - begins) / EVERY).astype(int)[:, None] + _AROUND
    there = (places >= 0) & (places < counts[:, None])
    return np.clip(places, 0, counts[:, None] - 1), there


class Calibration(NamedTuple):
    """The orbits inside past sets, over the span on which they agree best.

    span: the usual one where sets are too few to tell it; r, w: medians of the distances outwards and across
    the track of orbits of different days [m], NaN where they are too few; sunlight: the step of Cr A/m by
    which light presses; errors: of the orbits, as of `PastOrbits.errors`
    """

    span: FitSpan
    r: float
    w: float
    sunlight: float
    errors: pd.DataFrame

    @property
    def is_told(self) -> bool:
        """Whether sets are enough to tell the span."""
        return not np.isnan(self.w)


def agreement(
    past: PastOrbits, spans: Sequence[FitSpan] = SPANS, *, axes: Sequence[str] = ("r", "w")
) -> tuple[FitSpan, float, float] | None:
    """Return the span over which an object's sets agree best, and r and w as of `Calibration`; None where
    there are too few to tell.

    axes: along which they are to agree; outwards drag parts them, too. A span before the epochs has to be
    better by a factor, as the weather of the days after was not known; of two as good the earlier one is
    taken.
    """
    tried = []
    for span in spans:
        pairs = past.errors(past.numbers(span))
        distant = pairs.loc[pairs["days"] >= _APART / DAY, ["r", "w"]].dropna()
        if len(distant) >= _FEWEST:
            size = np.sqrt((distant**2).median())
            factor = 1.0 if span.is_centred else _UNLIKELY**2
            square = factor * float(sum(float(size[axis]) ** 2 for axis in axes))
            tried.append((square, (span, float(size["r"]), float(size["w"]))))
    return min(tried, key=lambda one: one[0])[1] if tried else None
