"""Better element sets for a morning: each object's newest set, its mean motion and B* corrected.

    known = improve.read(["catalogue"], date="2026-07-15T06:00:00", weather="SW-All.csv")
    better = improve.improve(known, model.read())
    better.write("better.tle")

Nothing counts that was not public on the date: later sets, later weather. Sets fly, by every tool that knows
SGP4, to where the corrected prediction is: a change of the mean motion and one of B* come nearest to the
corrections at all leads.
"""

import logging
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.element_sets import catalogue as catalogues
from opml.element_sets import corrector, density, features, pairs
from opml.element_sets.catalogue import ElementCatalogue, modified_julian_day, semi_major_axis
from opml.element_sets.model import CatalogueModel
from opml.element_sets.pairs import OLDEST
from opml.environment import knowledge
from opml.environment.weather import Weather
from opml.interop.element_sets import rewriting
from opml.interop.element_sets.rewriting import Better
from opml.tables import write_as

PAST = 20
"""Mornings before the date whose predictions tell which model an object gets."""

NEWER_WEATHER = "https://celestrak.org/SpaceData/SW-All.csv"
"""Where newer space weather is."""

OLDEST_WEATHER = 3.0
"""Days before the date that the weather may end: the forecast begins there."""

_BORROWED = 30.0
"""Rows of its band that count in an object's own past, so that a short one decides little."""

_GROSS = 4.0
"""Largest part of a scale that a miss counts in the choice."""

_FEWEST_SETS = 3
_BURN = 25.0
"""Scales by which a set misses those before it where the object has burned."""

_MOST_DRAG = 0.9
"""Largest part of its B* that is taken off a set."""

_DEEP = 2.0 * np.pi / 225.0  # mean motion [rad/min] below which SGP4 adds Sun and Moon
_MINUTES = 1440.0

UNCHANGED, DENSITY, LEARNED, FEW = "unchanged", "density", "learned", "first sets"

_log = logging.getLogger(__name__)

Progress = Callable[[str], None]
"""Takes a line that tells what is going on."""


@dataclass(frozen=True, eq=False)
class PublicData:
    """What is public on a date: sets, and the weather up to it.

    date: UTC text
    weather: clean, no later than the date
    """

    catalogue: ElementCatalogue
    weather: Weather
    date: str


@dataclass(frozen=True, eq=False)
class Improved:
    """Element sets for a date.

    table: `improved_sets`, a row an object
    sets: those of the table, as they are written
    date: UTC text
    past: judged predictions of the mornings before: number, morning (modified Julian day), lead [d], error
        (of SGP4), left (of it, by the way that the object's set is improved now), sigma [m]
    """

    table: pd.DataFrame
    sets: list[Better]
    date: str
    past: pd.DataFrame

    def write(self, path: FilePath) -> int:
        """Write the sets in the format of the suffix; return how many it cannot hold.

        Raises InputError for another suffix.
        """
        return rewriting.write(path, self.sets)

    def write_table(self, path: FilePath) -> None:
        """Write the table as CSV, JSON or Parquet, by the suffix."""
        write_as(path, self.table, "improved_sets", metadata={"date": self.date})


def read(
    paths: Iterable[FilePath], *, date: str, weather: str | Path, latency: float = catalogues.LATENCY
) -> PublicData:
    """Read what was public on a date (UTC text).

    paths: files and folders of element sets
    weather: OBSERVED, the packaged weather, or a CSSI file
    latency: days from epoch to publication of sets that do not tell when they were made

    Raises InputError for an unreadable file, for weather that ends too early, and where no set was public.
    """
    today = modified_julian_day(date)
    found = knowledge.read(weather).keep_known(today)
    check_newest(found, weather, date=date, oldest=OLDEST_WEATHER)
    sets = catalogues.read(paths, latency=latency).until(today).daily()
    if sets.table.empty:
        raise InputError(f"element sets: expected some that were public on {date}, got none")
    return PublicData(sets, density.clean(found), date)


def check_newest(found: Weather, source: FilePath, *, date: str, oldest: float) -> None:
    """Raise InputError for weather of a source that ends more than so many days before a date (UTC text)."""
    end = density.end_of(found)
    if modified_julian_day(date) - end > oldest:
        expected = f"space weather measured up to {date[:10]}, got it up to {epochs.calendar(end)}"
        raise InputError(f"{source}: expected {expected}; newer: {NEWER_WEATHER}")


def improve(known: PublicData, model: CatalogueModel, *, progress: Progress = _log.info) -> Improved:
    """Return the newest set of each object, improved where its past shows that it gains.

    progress: takes a line for each stage
    """
    progress(f"{known.catalogue.table['number'].nunique()} objects, {len(known.catalogue.table)} sets")
    today = modified_julian_day(known.date)
    rows = replayed(known, model, np.arange(-PAST, 1) + today)
    progress(f"{len(rows)} predictions of {PAST + 1} mornings")
    ways = candidates(rows, model)
    is_today = rows["morning"] == today
    table = _table(
        known,
        rows[is_today],
        {name: one[is_today] for name, one in ways.items()},
        choice(rows, ways),
    )
    sets = [Better(one.file, one.line, one.motion, one.bstar) for one in table.itertuples(index=False)]
    progress(", ".join(f"{name} {count}" for name, count in table["applied"].value_counts().items()))
    way = table["applied"] + (": " + table["population"]).where(table["population"].ne(""), "")
    past = _past(rows, ways, way.set_axis(table["number"]))
    return Improved(table.drop(columns=["file", "line"]), sets, known.date, past)


def _past(rows: pd.DataFrame, ways: Mapping[str, pd.DataFrame], way: pd.Series) -> pd.DataFrame:
    """Return the judged rows with what their object's way leaves of the error."""
    judged = rows[np.isfinite(rows["error"])]
    past = judged[["morning", "error"]].join(of_way(judged, ways, way), how="inner")
    past["left"] = past["error"] - past["correction"]
    return past[["number", "morning", "lead", "error", "left", "sigma"]].reset_index(drop=True)


def replayed(known: PublicData, model: CatalogueModel, mornings: np.ndarray) -> pd.DataFrame:
    """Return the rows of `features.build` on mornings, each with what was known on it."""
    first = int(np.floor(min(mornings[0], density.end_of(known.weather)))) - density.RUN_UP - 1
    densities = density.measured(known.weather, first, density.end_of(known.weather))
    air = density.LearnedAir(known.weather, densities, model.outlook)
    return features.build(known.catalogue, pairs.build(known.catalogue, mornings), air)


def candidates(rows: pd.DataFrame, model: CatalogueModel) -> dict[str, pd.DataFrame]:
    """Return correction and sigma [m] of rows by each way to correct them: not, by the density, as learned.

    A prediction apart from the learned one is as unsure as that, and as they are apart.
    """
    learned = {
        f"{LEARNED}: {name}": corrector.widen(rows, one.apply(rows)) for name, one in model.correctors.items()
    }
    surest = pd.concat(learned.values()).groupby(level=0).mean()
    ways = {UNCHANGED: 0.0 * rows["density"], DENSITY: rows["density"]}
    plain = {
        name: pd.DataFrame(
            {"correction": one, "sigma": np.hypot(surest["sigma"], surest["correction"] - one)}
        )
        for name, one in ways.items()
    }
    return plain | learned


def choice(rows: pd.DataFrame, ways: Mapping[str, pd.DataFrame]) -> pd.Series:
    """Return the way by the number of the object: the one that left least of the predictions that are judged.

    Rows of the whole band stand in where an object has few of its own.
    """
    judged = rows["is_fit"] & np.isfinite(rows["error"])
    own = rows[judged]
    losses = pd.DataFrame(
        {
            name: np.minimum(np.abs(own["error"] - one.loc[judged, "correction"]) / own["scale"], _GROSS)
            for name, one in ways.items()
        }
    )
    of_band = losses.groupby(own["band"]).mean()
    band = rows.groupby("number")["band"].last()
    usual = of_band.reindex(band).set_axis(band.index)
    sums = losses.groupby(own["number"]).sum().reindex(band.index, fill_value=0.0)
    counts = own.groupby("number").size().reindex(band.index, fill_value=0)
    scores = (sums + _BORROWED * usual).div(counts + _BORROWED, axis=0)
    chosen = scores.fillna(np.inf).idxmin(axis=1)
    return chosen.where(np.isfinite(scores.min(axis=1)), DENSITY)


def _table(
    known: PublicData, rows: pd.DataFrame, ways: Mapping[str, pd.DataFrame], chosen_ways: pd.Series
) -> pd.DataFrame:
    """Return the table `improved_sets` with file and line of each set.

    rows: those of the date, of the objects that have a set that is new enough
    """
    today = modified_julian_day(known.date)
    newest = newest_sets(known.catalogue)
    why = reasons(known.catalogue, newest, rows, date=today)
    way = where_usable(chosen_ways, why)
    chosen = of_way(rows, ways, way)
    improved = numbers(newest, chosen)
    table = pd.DataFrame(
        {
            "number": newest["number"],
            "t": newest["t"],
            "age": today - newest["t"],
            "height": newest["height"],
            "applied": way.str.partition(":")[0],
            "population": way.str.partition(": ")[2],
            "why": why,
            "motion": improved["motion"],
            "bstar": improved["bstar"],
            "motion_before": newest["motion"],
            "bstar_before": newest["bstar"],
        }
    )
    for lead in pairs.LEADS:
        one = chosen[chosen["lead"] == lead].set_index("number").reindex(newest.index)
        table[f"sgp4_{lead}d"] = np.hypot(one["sigma"], one["correction"])
        table[f"sigma_{lead}d"] = one["sigma"]
    return table.assign(file=newest["file"], line=newest["line"]).reset_index(drop=True)


def newest_sets(catalogue: ElementCatalogue) -> pd.DataFrame:
    """Return the newest set of each object, by its number."""
    return catalogue.table.groupby("number", sort=True).tail(1).set_index("number", drop=False)


def reasons(
    catalogue: ElementCatalogue, newest: pd.DataFrame, rows: pd.DataFrame, *, date: float
) -> pd.Series:
    """Return by the number of the object why its past does not choose, '' where it does.

    newest: of `newest_sets`
    rows: those of the date, a modified Julian day
    """
    counts = catalogue.table.groupby("number").size()
    missed = rows.groupby("number")["missed"].max()
    age = date - newest["t"]
    found = {
        FEW: counts < _FEWEST_SETS,
        "burned lately": missed.reindex(newest.index, fill_value=0.0) > _BURN,
        f"newest set older than {OLDEST:g} d": age > OLDEST,
        "no B* above 0": newest["bstar"] <= 0.0,
        "eccentric": newest["eccentricity"] >= features.MOST_ECCENTRICITY,
        "outside the bands of height": ~newest["height"].between(*features.BANDS[[0, -1]], inclusive="left"),
        "deep space": newest["motion"] < _DEEP,
    }
    why = pd.Series("", index=newest.index)
    for reason, holds in found.items():
        why = why.mask(holds, reason)
    return why


def where_usable(way: pd.Series, why: pd.Series) -> pd.Series:
    """Return the way of each object: the density of one with few sets, none of others with a reason."""
    return way.reindex(why.index).where(why.isin(["", FEW]), UNCHANGED).mask(why.eq(FEW), DENSITY)


def of_way(rows: pd.DataFrame, ways: Mapping[str, pd.DataFrame], way: pd.Series) -> pd.DataFrame:
    """Return rows that can be corrected with correction and sigma of their object's way."""
    of_row = rows["number"].map(way)
    parts = [
        rows[["number", "lead", "tau", "response"]].join(one)[rows["is_fit"] & of_row.eq(name)]
        for name, one in ways.items()
    ]
    return pd.concat(parts).sort_index()


def numbers(newest: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Return mean motion [rad/min] and B* of the newest sets, improved by the corrections of rows."""
    return newest[["motion", "bstar"]] + _changes(newest, rows)


def _changes(newest: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Return the changes of mean motion [rad/min] and B* by object that come nearest to the corrections.

    Distances count by the inverse of the time to them to the power of 1.5, as errors grow. Along the track a
    change of the mean motion goes with tau, one of B* with the response. Some of the drag stays: without it
    an orbit would rise.
    """
    tau = rows["tau"]
    rate, sought = rows["response"] / tau, rows["correction"] / tau
    sums = pd.DataFrame({"n": 1.0, "r": rate, "rr": rate**2, "s": sought, "rs": rate * sought}).div(
        tau, axis=0
    )
    n, r, rr, s, rs = (sums.groupby(rows["number"]).sum()[name] for name in ("n", "r", "rr", "s", "rs"))
    bstar = (n * rs - r * s) / (n * rr - r * r)
    bstar = np.minimum(bstar, _MOST_DRAG * newest["bstar"].reindex(bstar.index))
    speed = (s - bstar * r) / n  # [m/d]
    radius = pd.Series(semi_major_axis(newest["motion"].to_numpy()), index=newest.index)
    found = pd.DataFrame({"motion": -speed / (_MINUTES * radius), "bstar": -bstar})
    return found.reindex(newest.index).fillna(0.0)
