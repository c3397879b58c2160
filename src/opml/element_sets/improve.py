"""Better element sets for a morning: each object's newest set, its mean motion and B* corrected.

    known = improve.read(["catalogue"], date="2026-07-15T06:00:00", weather="SW-All.csv")
    better = improve.improve(known, model.read())
    better.write("better.tle")

Nothing counts that was not public on the date: later sets, later weather. Sets are propagated, by every tool
that knows SGP4, to where the corrected prediction is: a change of the mean motion and one of B* come nearest
to the corrections at all leads.
"""

import logging
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath, check_distinct_files, suffix_of
from opml.base.progress import Progress, counted
from opml.element_sets import (
    catalogue as catalogues,
    corrector,
    density,
    features,
    set_errors,
    trained_model,
    weighting,
)
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.set_errors import OLDEST
from opml.element_sets.trained_model import CatalogueModel
from opml.element_sets.weighting import DENSITY, PAST, UNCHANGED
from opml.environment import known_weather
from opml.environment.weather import Weather
from opml.interop.element_sets import known_sets, rewriting
from opml.interop.element_sets.element_set import DEEP_SPACE, semi_major_axis
from opml.interop.element_sets.rewriting import Better
from opml.tables import TABLE_SUFFIXES, write_as

FEWEST_SETS = 3  # of an object whose past tells something
_MOST_BSTAR = 0.1  # of a body that is no balloon, some 0.6 m2/kg; more is a fit that failed
_PAST_COLUMNS = ["number", "morning", "lead", "error", "left", "sigma"]
_MINUTES = 1440.0
_WHERE = ("file", "place", "line")

FEW, SEVERAL = f"fewer than {FEWEST_SETS} sets", "sets of several orbits"
UNSEEN = "height that the model never saw"
_FARTHEST = 1e6
"""What SGP4 is off along the track after a day, in a quarter of the mornings, where sets are of several
orbits [m]."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class PublicData:
    """Public data on a date: sets, and the weather up to it."""

    catalogue: ElementCatalogue
    weather: Weather  # clean, no later than the date
    date: str  # UTC text


@dataclass(frozen=True, eq=False)
class Improved:
    """Element sets for a date.

    past: judged predictions of the mornings before: number, morning (modified Julian day), lead [d], error
        (of SGP4), left (of it, as the object's set is improved now), sigma [m]
    corrections: those of the date: number, lead [d], correction (what SGP4 is ahead of the track), sigma [m]
    hindsight: a warning where the model was trained on what came after the date, else ''
    """

    table: pd.DataFrame  # `improved_sets`, a row an object
    sets: list[Better]  # those of the table, as they are written
    date: str  # UTC text
    past: pd.DataFrame
    corrections: pd.DataFrame
    hindsight: str

    def write(self, path: FilePath) -> int:
        """Write the sets in the format of the suffix; return how many it cannot hold.

        Raises InputError for another suffix.
        """
        return rewriting.write(path, self.sets)

    def write_table(self, path: FilePath) -> None:
        """Write the table as CSV, JSON or Parquet, by the suffix."""
        write_as(path, self.table, "improved_sets", metadata={"date": self.date, "hindsight": self.hindsight})


def read(
    paths: Iterable[FilePath], *, date: epochs.Time, weather: str | Path, latency: float = known_sets.LATENCY
) -> PublicData:
    """Read what was public on a date (UTC).

    paths: files and folders of element sets
    weather: OBSERVED, the packaged weather, or a CSSI file
    latency: days from epoch to publication of sets that do not say when they were made

    Raises InputError for an unreadable file, for weather that ends too early, and where no set was public.
    """
    date = epochs.instant(date)
    known = known_weather.known_on(date, known_weather.read(weather), weather)
    return public_on(date, catalogues.read(paths, latency=latency), known)


def public_on(date: str, catalogue: ElementCatalogue, weather: Weather) -> PublicData:
    """Return what was public on a date (UTC text); weather: known on it; raises InputError for no set."""
    sets = catalogue.until(epochs.mjd(date)).daily()
    if sets.table.empty:
        raise InputError(f"element sets: expected some that were public on {date}, got none")
    return PublicData(sets, density.clean(weather), date)


def check_written(better: FilePath, table: FilePath | None, paths: Iterable[FilePath]) -> None:
    """Raise InputError for files to write whose suffix has no format, or that are among those to read.

    better: of sets; table: None for none; paths: files and folders of element sets
    """
    suffix_of(better, rewriting.WRITERS)
    if table:
        suffix_of(table, TABLE_SUFFIXES)
    written = [better, *([table] if table else [])]
    check_distinct_files(written, paths)
    for path, folder in product(written, map(Path, paths)):
        if folder.is_dir() and folder.resolve() in Path(path).resolve().parents:
            raise InputError(f"{path}: expected a file outside {folder}, as all sets in there are read")


def improve(known: PublicData, model: CatalogueModel, *, progress: Progress = _log.info) -> Improved:
    """Return the newest set of each object, improved where its past shows that it gains.

    progress: takes a line for each stage
    """
    sets = known.catalogue.table
    progress(f"{counted(sets['number'].nunique(), 'object')}, {counted(len(sets), 'set')}")
    today = epochs.mjd(known.date)
    rows = replayed(known, model, np.arange(-PAST, 1) + today)
    is_judged = np.isfinite(rows["error"])
    mornings = rows.loc[is_judged, "morning"].nunique()
    progress(
        f"{counted(int(is_judged.sum()), 'past prediction')} replayed, of {counted(mornings, 'morning')}"
    )
    jump = corrector.jumps(rows)
    tried = weighting.candidates(rows, model.correctors, jump)
    # What correctors alone look at is more than half of the rows' memory.
    rows = rows.drop(columns=list(features.APART))
    now = rows[rows["morning"] == today].assign(jump=jump)
    newest = known.catalogue.newest().by_number
    why = reasons(known.catalogue, newest, rows, date=today)
    some = next(iter(tried.values()))["sigma"].reindex(now.index)  # of any way: the sizes are of the model
    unseen = now.loc[now["is_fit"] & some.isna(), "number"]
    why = why.mask(why.eq("") & why.index.isin(unseen), UNSEEN)
    weights = where_usable(weighting.weights(rows, tried), why)
    combined = weighting.combined(rows, tried, weighting.of_objects(weights, rows))
    now = now.join(combined[["correction", "sigma"]])
    table = _table(newest, today - newest["t"], why, weights, now)
    sets = [
        Better(one.file, one.place, one.line, one.motion, one.bstar) for one in table.itertuples(index=False)
    ]
    counts = table["applied"].value_counts().items()
    progress("along the track: " + ", ".join(f"{name} for {counted(count, 'set')}" for name, count in counts))
    judged = rows.loc[is_judged, ["morning", "error"]].join(combined, how="inner")
    past = judged.assign(left=judged["error"] - judged["correction"])[_PAST_COLUMNS].reset_index(drop=True)
    corrections = now[["number", "lead", "correction", "sigma"]].dropna().reset_index(drop=True)
    hindsight = trained_model.hindsight(model.card, known.date)
    return Improved(table.drop(columns=[*_WHERE]), sets, known.date, past, corrections, hindsight)


def replayed(known: PublicData, model: CatalogueModel, mornings: np.ndarray) -> pd.DataFrame:
    """Return the rows of `features.build` on mornings, each with what was known on it.

    mornings: a day apart; those that the weather does not reach are left out, but for the last one
    """
    mornings = mornings[(mornings >= density.first_morning(known.weather)) | (mornings == mornings[-1])]
    first = int(np.floor(min(mornings[0], known.weather.end))) - density.RUN_UP - 1
    densities = density.measured(known.weather, first, known.weather.end)
    air = density.air(known.weather, densities, model.outlook)
    return features.build(known.catalogue, set_errors.build(known.catalogue, mornings), air)


def _table(
    newest: pd.DataFrame, age: pd.Series, why: pd.Series, weights: pd.DataFrame, rows: pd.DataFrame
) -> pd.DataFrame:
    """Return the table `improved_sets` with _WHERE each set is.

    age: of the newest sets [d]
    rows: those of the date, with jumps and corrections, of the objects that have a set that is new enough
    """
    way = weights.idxmax(axis=1)
    corrected = rows.dropna(subset="correction")
    improved = numbers(newest, corrected)
    table = pd.DataFrame(
        {
            "number": newest["number"],
            "t": newest["t"],
            "age": age,
            "height": newest["height"],
            "applied": way.str.partition(":")[0],
            "population": way.str.partition(": ")[2],
            "weight": weights.max(axis=1),
            "why": why,
            "motion": improved["motion"],
            "bstar": improved["bstar"],
            "motion_before": newest["motion"],
            "bstar_before": newest["bstar"],
            "jump": rows.groupby("number")["jump"].max().reindex(newest.index),
        }
    )
    for lead in set_errors.LEADS:
        of_lead = corrected[corrected["lead"] == lead].set_index("number").reindex(newest.index)
        table[f"sgp4_{lead}d"] = np.hypot(of_lead["sigma"], of_lead["correction"])
        table[f"sigma_{lead}d"] = of_lead["sigma"]
    return table.assign(**newest[[*_WHERE]]).reset_index(drop=True)


def reasons(
    catalogue: ElementCatalogue, newest: pd.DataFrame, rows: pd.DataFrame, *, date: float
) -> pd.Series:
    """Return by the number of the object why its past does not weigh the ways, '' where it does.

    newest: `by_number` of the newest sets
    rows: of the mornings up to the date, a modified Julian day
    """
    counts = catalogue.table.groupby("number").size()
    missed = rows[rows["morning"] == date].groupby("number")["missed"].max()
    after_a_day = rows.loc[rows["lead"] == set_errors.LEADS[0], "error"].abs()
    off = after_a_day.groupby(rows["number"]).quantile(0.75)
    age = date - newest["t"]
    conditions = {
        FEW: counts < FEWEST_SETS,
        "burned lately": missed.reindex(newest.index, fill_value=0.0) > weighting.BURN,
        f"newest set older than {OLDEST:g} d": age > OLDEST,
        "no B* above 0": newest["bstar"] <= 0.0,
        f"B* above {_MOST_BSTAR:g}": newest["bstar"] > _MOST_BSTAR,
        "eccentric": newest["eccentricity"] >= features.MOST_ECCENTRICITY,
        "outside the bands of height": ~newest["height"].between(*features.BANDS[[0, -1]], inclusive="left"),
        "deep space": newest["motion"] < DEEP_SPACE,
        SEVERAL: off.reindex(newest.index, fill_value=0.0) > _FARTHEST,
    }
    why = pd.Series("", index=newest.index)
    for reason, holds in conditions.items():
        why = why.mask(holds, reason)
    return why


def where_usable(weights: pd.DataFrame, why: pd.Series) -> pd.DataFrame:
    """Return the weights of each object: the density alone with few sets, none else with another reason.

    weights: of `weighting.weights`
    """
    others = weighting.sole(why.eq(FEW).map({True: DENSITY, False: UNCHANGED}))
    return weighting.replaced(weights.reindex(why.index), others, why.ne(""))


def numbers(newest: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Return mean motion [rad/min] and B* of the newest sets, improved by the corrections of rows."""
    changes = weighting.changes(rows, rows["number"], newest["bstar"]).reindex(newest.index).fillna(0.0)
    radius = semi_major_axis(newest["motion"].to_numpy())
    motion = newest["motion"] - changes["speed"] / (_MINUTES * radius)
    return pd.DataFrame({"motion": motion, "bstar": newest["bstar"] - changes["bstar"]})
