"""The orbits inside the sets of an object's last weeks: the span over which they agree, and how far they
erred.

No truth is needed to find the span over which a publisher fits. Taken over the right one, the orbits of two
sets of different days agree across the track to metres; over another they are off by what SGP4 lacks. The
same orbits give the error of each at later sets: the errors that its next one will have.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.element_sets.inside.orbit_inside import EVERY, LIGHT_STEP, Equations, NearbyOrbit, solve
from opml.orbits.elements import bent_rsw


@dataclass(frozen=True)
class FitSpan:
    """Time before and after the epoch of a set that its publisher fitted SGP4 over [s]."""

    before: float
    after: float

    @property
    def is_centred(self) -> bool:
        """Return whether the span is as long after the epoch as before it, as of sets with an orbit
        inside.
        """
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

_APART = 4.0 * DAY  # least time between two sets that tell whether a span is right [s]
_FEWEST = 3  # pairs of sets that tell a span
_UNLIKELY = 1.5  # by what orbits over a span before the epochs have to agree better than over others
_INDEPENDENT, _AGREED = 4.0, 10.0  # pairs that count each for itself, and what they agree to [m]
GUESSED_LIGHT = 0.01  # standard deviation of Cr A/m of who knows nothing of a body [m2/kg]
_AROUND = np.arange(-3, 4)  # points about the epoch of a later set: nearly two revolutions of a low orbit


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
        rows = [
            (i, j, (self.t[j] - self.t[i]) / DAY, *_sizes(off), *_sizes(off + self._by_sgp4(i, j, numbers)))
            for i, j, off in self._off(numbers)
        ]
        names = ["r", "s", "w", "ahead"]
        columns = ["i", "j", "days", *names, *(f"sgp4_{name}" for name in names)]
        return pd.DataFrame(rows, columns=columns, dtype=float)

    def sunlight(self, span: FitSpan) -> float:
        """Return the step of Cr A/m over which orbits of a span agree best outwards: it shifts their
        perigees.

        Pairs of sets count as _INDEPENDENT ones, and the number first taken as one more, off by
        GUESSED_LIGHT.
        """
        dark, lit = (
            [off[:, 0] for i, j, off in self._off(self.numbers(span, step)) if self._are_apart(i, j)]
            for step in (0.0, 1.0)
        )
        if len(dark) < _FEWEST:
            return 0.0
        off, change = np.concatenate(dark), np.concatenate(lit) - np.concatenate(dark)
        weight = _INDEPENDENT / (_AGREED**2 * len(off))
        guess = (LIGHT_STEP / GUESSED_LIGHT) ** 2
        return float(-weight * (off @ change) / (weight * (change @ change) + guess))

    def _off(self, numbers: np.ndarray) -> Iterator[tuple[int, int, np.ndarray]]:
        """Yield sets i and j with what the orbit of i is off that of j about its epoch (points, 3) [m]."""
        for j, judge in enumerate(self.orbits):
            own = _places(judge, self.t[j])
            states = np.hstack([judge.positions(numbers[j], own), judge.states[own, 3:]])
            for i in range(j):
                if self.t[j] - self.t[i] <= REACH:
                    places = _places(self.orbits[i], self.t[j])
                    positions = self.orbits[i].positions(numbers[i], places)
                    yield i, j, bent_rsw(positions, states[: len(places)])

    def _by_sgp4(self, i: int, j: int, numbers: np.ndarray) -> np.ndarray:
        """Return what SGP4 from set i is off its orbit about the epoch of set j (points, 3) [m]."""
        places = _places(self.orbits[i], self.t[j])
        return np.asarray(self._off_sgp4[i][places] - self.orbits[i].partials[places] @ numbers[i])

    def _are_apart(self, i: int, j: int) -> bool:
        return bool(self.t[j] - self.t[i] >= _APART)

    @cached_property
    def _off_sgp4(self) -> list[np.ndarray]:
        return [orbit.displacements(orbit.beginning.satellite) for orbit in self.orbits]


def _places(orbit: NearbyOrbit, t: float) -> np.ndarray:
    """Return the points of an orbit about a time."""
    places = int(np.round((t - orbit.t[0]) / EVERY)) + _AROUND
    return places[(places >= 0) & (places < len(orbit.t))]


def _sizes(off: np.ndarray) -> tuple[float, ...]:
    return (*np.sqrt((off**2).mean(axis=0)), float(off[:, 1].mean()))


@dataclass(frozen=True)
class Agreement:
    """Agreement of the orbits of sets of different days over the best span.

    r, w: medians of their distances outwards and across the track [m]
    """

    span: FitSpan
    r: float
    w: float


def agreement(
    past: PastOrbits, spans: Sequence[FitSpan] = SPANS, *, axes: Sequence[str] = ("r", "w")
) -> Agreement | None:
    """Return the span over which an object's sets agree best; None where there are too few to tell.

    axes: along which they are to agree; outwards drag parts them, too. A span before the epochs has to be
    better by a factor, as the weather of the days after was not known; of two as good the earlier one is
    taken.
    """
    tried = []
    for span in spans:
        pairs = past.errors(past.numbers(span))
        distant = pairs.loc[pairs["days"] >= _APART / DAY, ["r", "w"]].dropna()
        if len(distant) >= _FEWEST:
            r, w = np.sqrt((distant**2).median())
            tried.append(Agreement(span, float(r), float(w)))

    def square(one: Agreement) -> float:
        factor = 1.0 if one.span.is_centred else _UNLIKELY**2
        return factor * float(sum(getattr(one, axis) ** 2 for axis in axes))

    return min(tried, key=square) if tried else None
