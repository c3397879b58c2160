"""A corrector on trial: learned from one half of the objects in a season, judged on the other half later."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.element_sets import catalogue as catalogues
from opml.element_sets import corrector, density, features, set_errors, weighting
from opml.element_sets.catalogue import ElementCatalogue, modified_julian_day
from opml.element_sets.density import Densities, LearnedAir
from opml.element_sets.features import FEATURES
from opml.element_sets.training import FIRST_DAY, HOUR_OF_MORNING
from opml.element_sets.weighting import PAST
from opml.environment import known_weather
from opml.interop import ccsds
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import seconds_since
from opml.orbits.elements import bent_rsw
from opml.tables import STATE, catalogue_densities_schema, catalogue_rows_schema

_HEIGHTS = [f"log_density_{height / 1e3:g}km" for height in density.HEIGHTS]

DENSITIES = catalogue_densities_schema(_HEIGHTS)  # schema of the table of mean densities
ROWS = catalogue_rows_schema([name for name in FEATURES if name != "lead"])  # schema of the table of rows
SET, ORBIT = "set", "orbit"  # what judges: a later set, or the orbit inside it
_EPOCH = "2000-01-01T12:00:00"  # UTC from which times count
_SETS_BEFORE = 30.0  # days of sets before the first morning, for the levels of drag
_SETS_AFTER = 10.0  # days of sets after the last morning, which judge


@dataclass(frozen=True)
class Seasons:
    """First and last day (modified Julian days, UTC) that is learned from, and that judges."""

    train: tuple[float, float]
    test: tuple[float, float]

    @classmethod
    def of_dates(cls, train: Sequence[str], test: Sequence[str]) -> Self:
        """Return the seasons between dates 'YYYY-MM-DD'. Raises InputError for a malformed one."""
        days = [modified_julian_day(f"{date}T00:00:00") for date in (*train, *test)]
        return cls((days[0], days[1]), (days[2], days[3]))

    @property
    def mornings(self) -> np.ndarray:
        """Mornings of both seasons, and those before each, an object's past."""
        days = [np.arange(first - PAST, last + 1.0) for first, last in (self.train, self.test)]
        return np.union1d(*days) + HOUR_OF_MORNING

    @property
    def needed(self) -> tuple[float, float]:
        """First and last day whose predictions judge, or weight the candidates of one that does."""
        return self.test[0] - PAST, self.test[1]


def densities(weather: str | Path) -> pd.DataFrame:
    """Return the table DENSITIES since 2002 under measured weather, OBSERVED or a CSSI file.

    Raises InputError where the weather is unreadable.
    """
    known = density.clean(known_weather.read(weather))
    air = density.measured(known, max(FIRST_DAY, known.first + density.RUN_UP), density.end_of(known))
    t = air.first + np.arange(len(air.log)) / density.QUARTERS
    return pd.DataFrame(air.log, columns=_HEIGHTS).assign(t=t)


def rows(
    files: Iterable[FilePath],
    table: pd.DataFrame,
    seasons: Seasons,
    *,
    orbits: pd.DataFrame,
    weather: str | Path,
    latency: float,
) -> pd.DataFrame:
    """Return the table ROWS of the mornings of both seasons.

    files: of element sets
    table: of `densities`; their forecast is learned from what was measured before both seasons
    orbits: `set_states`, the orbits inside sets that are known
    weather: that of the densities
    latency: days from epoch to publication of sets that do not say when they were made

    Raises InputError for unreadable files, weather that ends too early or begins too late, and without rows.
    """
    known = density.clean(known_weather.read(weather))
    last = max(seasons.train[1], seasons.test[1])
    if density.end_of(known) < last:
        expected = f"expected measured weather up to {epochs.calendar(last)}"
        raise InputError(f"{weather}: {expected}, got it up to {epochs.calendar(density.end_of(known))}")
    measured = Densities(int(table["t"].iloc[0]), table[_HEIGHTS].to_numpy())
    air = LearnedAir(
        known, measured, density.fit(measured, known, end=min(seasons.train[0], seasons.test[0]))
    )
    sets = _about(catalogues.read(files, latency=latency).daily(), seasons.mornings)
    rows = features.build(sets, set_errors.build(sets, seasons.mornings), air)
    rows["bstar"] = sets.table["bstar"].to_numpy()[rows["newest"]]
    rows["later"] = ahead_of_orbits(sets, orbits)[set_errors.find(sets, seasons.mornings)[1]]
    own = rows[rows["is_fit"] & (_within(rows, seasons.train) | _within(rows, seasons.needed))]
    if own["error"].isna().all():
        raise InputError("element sets: expected sets of the seasons that judge each other, got none")
    return own[ROWS.names]


def ahead_of_orbits(sets: ElementCatalogue, orbits: pd.DataFrame) -> np.ndarray:
    """Return by how much SGP4 is ahead of orbits inside sets at their epochs (sets,) [m]; NaN without one."""
    t = seconds_since(_EPOCH, sets.satellites)
    keys = pd.MultiIndex.from_arrays([sets.table["number"], ccsds.utc_texts(_EPOCH, t)])
    inside = orbits.set_index(["number", "utc"])[[*STATE]].reindex(keys).to_numpy(float)
    ahead = np.full(len(t), np.nan)
    for row in np.flatnonzero(np.isfinite(inside).all(axis=1)):
        own = mean_elements.states(sets.satellites[row], epoch=_EPOCH, t=t[row : row + 1])
        ahead[row] = bent_rsw(own[:, :3], inside[row : row + 1])[0, 1]
    return ahead


def _about(sets: ElementCatalogue, mornings: np.ndarray) -> ElementCatalogue:
    """Return the sets that count on mornings."""
    t = sets.table["t"]
    return sets.take(
        np.flatnonzero(t.between(mornings[0] - _SETS_BEFORE, mornings[-1] + _SETS_AFTER).to_numpy())
    )


def _within(table: pd.DataFrame, season: tuple[float, float]) -> np.ndarray:
    return np.asarray(np.floor(table["morning"]).between(*season))


def residuals(
    table: pd.DataFrame, others: pd.DataFrame, seasons: Seasons, learner: str, *, seed: int
) -> pd.DataFrame:
    """Return the table `catalogue_residuals`: what is left of the errors of objects not learned from.

    Later sets teach, and weigh the candidates: they are what a morning knows. The orbits inside them judge
    where they are known.

    table: ROWS of the objects that judge
    others: ROWS of the objects of the training, the same or others
    learner: one of corrector.LEARNERS

    One half of the objects is trained on, and none of these judges. Training rows were public
    before the first morning that judges, or predicted after the last. Where nothing could be learned for a
    band, the density-scaled prediction stands. Raises InputError where there is too little to learn from.
    """
    training = others[half_of(others["number"].to_numpy(), seed=seed) == 0]
    trained = _train(training, seasons, learner, seed=seed)
    is_own = ~table["number"].isin(training["number"].unique()) & _within(table, seasons.needed)
    judged = table[is_own].reset_index(drop=True).assign(is_fit=True)
    tried = weighting.candidates(judged, {learner: trained}, corrector.jumps(judged))
    left = _residuals(judged, tried, learner)
    return left[_within(left, seasons.test) & np.isfinite(left["error"])]


def _train(rows: pd.DataFrame, seasons: Seasons, learner: str, *, seed: int) -> corrector.Corrector:
    """Return what is learned from rows that were public before the season of the test, or predicted after."""
    is_outside = (rows["judged"] <= seasons.test[0]) | (rows["morning"] > seasons.test[1])
    training = rows[_within(rows, seasons.train) & is_outside]
    return corrector.fit(training.assign(is_fit=True), learner, seed=seed)


def _residuals(judged: pd.DataFrame, tried: weighting.Candidates, learner: str) -> pd.DataFrame:
    """Return the errors that each candidate leaves, and those of the improved set, weighted by the past."""
    learned, weights = tried[f"{weighting.LEARNED}: {learner}"], weighting.weights_of_rows(judged, tried)
    combined = weighting.combined(judged, tried, weights)
    # A set takes two numbers alone, speed and B*, so that it follows the corrections of all leads in part.
    sets = judged.groupby(["number", "morning"]).ngroup()
    displacement = weighting.displacement(combined, sets, judged["bstar"].groupby(sets).first())
    scaled = judged["error"] - judged["density"]
    left = {
        "error": judged["error"],
        "scaled": scaled,
        "learned": (judged["error"] - learned["correction"]).fillna(scaled),
        "improved": judged["error"] - displacement,
    }
    later = judged["later"]
    return judged[["number", "morning", "lead", "band"]].assign(
        **{name: off + later.fillna(0.0) for name, off in left.items()},
        sigma=learned["sigma"],
        improved_sigma=combined["sigma"],
        applied=weighting.main_candidates(weights).str.partition(":")[0],
        judge=np.where(later.isna(), SET, ORBIT),
    )


def half_of(numbers: np.ndarray, *, seed: int) -> np.ndarray:
    """Return 0 or 1 for each of the catalogue numbers (n,), by the number and the seed alone."""
    return corrector.drawn_halves(numbers, "half of a catalogue", seed=seed)
