"""The seasons of docs/learning.md: what a corrector learns from half of the objects, judged on the others.

    python -m validation.catalogue_seasons FOLDER [SEASON...]

FOLDER has a folder of element sets for each population of SEASONS, and CelesTrak's SW-All.csv; a table of
`opml orbit`, as `payloads.parquet`, holds orbits inside the sets of a population, which judge where they are
known. Residuals become `residuals/SEASON/LEARNER.parquet` in FOLDER, what is left of SGP4's errors by band of
height and lead `scores.tsv`. Intervals come from draws of weeks and objects, as those of the benchmark.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.seeds import derive
from opml.benchmark.scores import drawn_weights, weeks_of, weighted_median
from opml.element_sets import catalogue as catalogues, corrector, density, features, set_errors, weighting
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.density import Densities
from opml.element_sets.features import APART, BANDS
from opml.element_sets.set_errors import LEADS
from opml.element_sets.training import FIRST_DAY, HOUR_OF_MORNING
from opml.element_sets.weighting import PAST
from opml.environment import known_weather
from opml.environment.weather import Weather
from opml.interop import ccsds
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import seconds_since
from opml.interop.ephemeris import EPOCH
from opml.learning.judge.metrics import p_ml
from opml.learning.models import svr
from opml.learning.models.training_inputs import Training
from opml.orbits.elements import bent_rsw
from opml.tables import SCHEMAS, STATE, read_table

Days = tuple[float, float]  # first and last modified Julian day, UTC


@dataclass(frozen=True)
class Season:
    """Days whose mornings are learned from, and that judge; latency: days from epoch to publication of sets
    that do not say it.
    """

    population: str
    train: Days
    test: Days
    teachers: str  # population that is learned from
    latency: float = 0.25

    @classmethod
    def of(cls, population: str, *dates: str, teachers: str = "", hours: float = 6.0) -> "Season":
        """Return the season of dates: first and last to learn from, first and last that judge."""
        a, b, c, d = (epochs.mjd(f"{date}T00:00:00") for date in dates)
        return cls(population, (a, b), (c, d), teachers or population, hours / 24.0)

    @property
    def mornings(self) -> np.ndarray:
        """Mornings of both spans, and those before each, an object's past."""
        days = (np.arange(first - PAST, last + 1.0) for first, last in (self.train, self.test))
        return np.union1d(*days) + HOUR_OF_MORNING

    @property
    def needed(self) -> Days:
        """First and last day whose predictions judge, or weight the candidates of one that does."""
        return self.test[0] - PAST, self.test[1]


_SUMMER = ("2026-01-31", "2026-05-30", "2026-05-31", "2026-07-31")
_AUTUMN = ("2022-08-01", "2022-10-31")

SEASONS = {
    "summer": Season.of("payloads", *_SUMMER),
    "storms": Season.of("payloads", "2025-01-10", "2025-06-30", "2025-07-01", "2026-01-07"),
    "rise": Season.of("payloads", *_AUTUMN, "2022-11-01", "2023-02-20"),
    "fragments": Season.of("fragments", "2026-06-08", "2026-07-24", "2026-07-25", "2026-08-09"),
    # Too few objects of their own to learn from.
    "may2024": Season.of("weekly", *_AUTUMN, "2024-04-15", "2024-06-30", teachers="payloads"),
    "minimum": Season.of("histories", *_AUTUMN, "2018-01-01", "2020-12-31", teachers="payloads"),
    # Sets that come later.
    "summer12h": Season.of("payloads", *_SUMMER, hours=12.0),
    "summer24h": Season.of("payloads", *_SUMMER, hours=24.0),
}

SEED = 42
SET, ORBIT = "set", "orbit"  # what judges: a later set, or the orbit inside it
ALL = -1  # number of the band that stands for all of them

_SETS_BEFORE = 30.0  # days of sets before the first morning, for the levels of drag
_SETS_AFTER = 10.0  # days of sets after the last morning, which judge
_MODELS = ("scaled", "learned", "improved")
_SVR = svr.SvrSettings(
    kind=svr.KIND, kernel_scale=float(np.sqrt(2.0 * len(APART))), c=1.0, epsilon=0.1, tol=1e-3
)
_SVR_ROWS, _SVR_CLIP = 8000, 5.0
_INTERVAL = (2.5, 97.5)


def densities(known: Weather) -> Densities:
    """Return the mean densities since 2002 under measured weather."""
    first = max(FIRST_DAY, known.first + density.RUN_UP)
    return density.measured(known, first, known.end)


def rows(
    sets: ElementCatalogue, season: Season, known: Weather, measured: Densities, orbits: pd.DataFrame
) -> pd.DataFrame:
    """Return the rows of `features.build` of a season's mornings that can be corrected, with bstar and
    later, by how much SGP4 at the set that judges is ahead of the orbit inside it [m], NaN where unknown.

    measured: of `densities`, learned from up to the first morning; orbits: `set_states`
    """
    first = min(season.train[0], season.test[0])
    air = density.air(known, measured, density.fit(measured, known, end=first))
    mornings, t = season.mornings, sets.table["t"]
    around = t.between(mornings[0] - _SETS_BEFORE, mornings[-1] + _SETS_AFTER)
    own = sets.take(np.flatnonzero(around))
    table = features.build(own, set_errors.build(own, mornings), air)
    table["bstar"] = own.table["bstar"].to_numpy()[table["newest"]]
    table["later"] = ahead_of_orbits(own, orbits)[set_errors.find(own, mornings)[1]]
    return table[table["is_fit"] & (_within(table, season.train) | _within(table, season.needed))]


def ahead_of_orbits(sets: ElementCatalogue, orbits: pd.DataFrame) -> np.ndarray:
    """Return by how much SGP4 is ahead of orbits inside sets at their epochs (sets,) [m]; NaN without one."""
    t = seconds_since(EPOCH, sets.satellites)
    keys = pd.MultiIndex.from_arrays([sets.table["number"], ccsds.utc_texts(EPOCH, t)])
    inside = orbits.set_index(["number", "utc"])[[*STATE]].reindex(keys).to_numpy(float)
    ahead = np.full(len(t), np.nan)
    for row in np.flatnonzero(np.isfinite(inside).all(axis=1)):
        own = mean_elements.states(sets.satellites[row], epoch=EPOCH, t=t[row : row + 1])
        ahead[row] = bent_rsw(own[:, :3], inside[row : row + 1])[0, 1]
    return ahead


def _within(table: pd.DataFrame, days: Days) -> np.ndarray:
    return np.asarray(np.floor(table["morning"]).between(*days))


def residuals(
    table: pd.DataFrame, teachers: pd.DataFrame, season: Season, learner: str, *, seed: int = SEED
) -> pd.DataFrame:
    """Return what is left of the errors of objects that were not learned from.

    Later sets teach, and weigh the candidates: they are what a morning knows. The orbits inside them judge
    where they are known.

    table: `rows` of the objects that judge; teachers: those of the training, the same or others
    learner: one of LEARNERS

    One half of the objects is trained on, and none of these judges. Training rows were public before the
    first morning that judges, or predicted after the last. Where nothing could be learned for a band, the
    density-scaled prediction stands.
    """
    training = teachers[half_of(teachers["number"].to_numpy(), seed=seed) == 0]
    is_outside = (training["judged"] <= season.test[0]) | (training["morning"] > season.test[1])
    lessons = training[_within(training, season.train) & is_outside]
    trained = corrector.fit(lessons.assign(is_fit=True), seed=seed, **LEARNERS[learner])
    judges = ~table["number"].isin(training["number"].unique()) & _within(table, season.needed)
    judged = table[judges].reset_index(drop=True).assign(is_fit=True)
    left = _left(judged, weighting.candidates(judged, {learner: trained}, corrector.jumps(judged)), learner)
    return left[_within(left, season.test) & np.isfinite(left["error"])]


@dataclass(frozen=True, eq=False)
class ClippedSvr:
    """A support vector regression of variables that are held within some deviations of those it has seen."""

    model: svr.SvrModel

    @property
    def variables(self) -> tuple[str, ...]:
        """Its variables."""
        return self.model.variables

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return the predictions of rows x."""
        reach = _SVR_CLIP * self.model.x_scale
        return self.model.predict(np.clip(x, self.model.x_mean - reach, self.model.x_mean + reach))


def fit_svr(rows: pd.DataFrame, seed: int) -> ClippedSvr:
    """Return the paper's regression (Peng & Bai 2018) of a sample of the rows."""
    sample = corrector.drawn_rows(rows, _SVR_ROWS, seed)
    x = sample[list(APART)].to_numpy()
    mean, scale = x.mean(axis=0), x.std(axis=0)
    x = np.clip(x, mean - _SVR_CLIP * scale, mean + _SVR_CLIP * scale)
    return ClippedSvr(svr.fit(Training(x, sample["target"].to_numpy(), APART, seed), _SVR))


LEARNERS = {
    "trees": {},
    "svr": {
        "parts": [((band,), (lead,)) for band in range(len(BANDS) - 1) for lead in LEADS],
        "learn": fit_svr,
    },
}
"""What `corrector.fit` takes for each learner: the paper's has a model for each band and lead."""


def half_of(numbers: np.ndarray, *, seed: int) -> np.ndarray:
    """Return 0 or 1 for each of the catalogue numbers (n,), by the number and the seed alone."""
    return corrector.drawn_halves(numbers, "half of a catalogue", seed=seed)


def _left(judged: pd.DataFrame, tried: weighting.Candidates, learner: str) -> pd.DataFrame:
    """Return the errors that each candidate leaves, and those of the improved set, weighted by the past."""
    learned, weights = tried[f"{weighting.LEARNED}: {learner}"], weights_of_rows(judged, tried)
    combined = weighting.combined(judged, tried, weights)
    # A set takes two numbers alone, speed and B*, so that it follows the corrections of all leads in part.
    sets = judged.groupby(["number", "morning"]).ngroup()
    of_set = weighting.changes(combined, sets, judged["bstar"].groupby(sets).first())
    changes = of_set.reindex(sets).set_axis(judged.index)
    scaled, later = judged["error"] - judged["density"], judged["later"]
    moved = changes["speed"] * combined["tau"] + changes["bstar"] * combined["response"]
    left = {
        "error": judged["error"],
        "scaled": scaled,
        "learned": (judged["error"] - learned["correction"]).fillna(scaled),
        "improved": judged["error"] - moved,
    }
    return judged[["number", "morning", "lead", "band"]].assign(
        **{name: off + later.fillna(0.0) for name, off in left.items()},
        sigma=learned["sigma"],
        improved_sigma=combined["sigma"],
        applied=weights.idxmax(axis=1).str.partition(":")[0],
        judge=np.where(later.isna(), SET, ORBIT),
    )


def weights_of_rows(judged: pd.DataFrame, tried: weighting.Candidates) -> pd.DataFrame:
    """Return the weights of each row, as `weighting.weights` has them on the row's morning of what was judged
    by then; judged: rows on daily mornings.
    """
    parts = []
    for morning in np.unique(judged["morning"]):
        past = judged[judged["morning"].between(morning - PAST, morning)]
        known = past.assign(error=past["error"].where(past["judged"] <= morning))
        weights = weighting.weights(known, {name: one.loc[past.index] for name, one in tried.items()})
        parts.append(weighting.of_objects(weights, past[past["morning"] == morning]))
    burned = judged.groupby(["number", "morning"])["missed"].transform("max") > weighting.BURN
    unchanged = weighting.sole(pd.Series(weighting.UNCHANGED, judged.index))
    return weighting.replaced(pd.concat(parts).reindex(judged.index), unchanged, burned)


def scores(left: pd.DataFrame, *, seed: int = SEED) -> pd.DataFrame:
    """Return shares [%] of SGP4's errors by band and lead, all bands together first; left: `residuals`."""
    parts = []
    for table in (left.assign(band=ALL), left):
        for (band, lead), part in table.groupby(["band", "lead"]):
            rng = derive(seed, "weeks and objects", str(band), str(lead))
            parts.append({"band": band, "lead": lead, **_score(part), **intervals(part, rng)})
    return pd.DataFrame(parts)


def _score(part: pd.DataFrame) -> dict[str, float]:
    """Return the numbers of one band and lead but for their intervals."""
    sgp4 = part["error"].abs()
    scores = {
        "predictions": len(part),
        "objects": part["number"].nunique(),
        "weeks": len(np.unique(weeks_of(part))),
        "by_orbits": 100.0 * (part["judge"] == ORBIT).mean(),
        "sgp4_median": sgp4.median(),
        "sgp4_p95": sgp4.quantile(0.95),
        "coverage": coverage(part["learned"], part["sigma"]),
        "improved_coverage": coverage(part["improved"], part["improved_sigma"]),
        "worst_week": min(
            coverage(week["improved"], week["improved_sigma"]) for _, week in part.groupby(weeks_of(part))
        ),
        "unchanged": 100.0 * (part["applied"] == weighting.UNCHANGED).mean(),
    }
    for model in _MODELS:
        size = part[model].abs()
        scores |= {
            f"{model}_median": 100.0 * size.median() / sgp4.median(),
            f"{model}_p95": 100.0 * size.quantile(0.95) / sgp4.quantile(0.95),
            f"{model}_p_ml": p_ml(part["error"].to_numpy(), (part["error"] - part[model]).to_numpy()),
        }
    return scores


def coverage(left: pd.Series, sigma: pd.Series) -> float:
    """Return the share [%] of what is left inside its intervals of corrector.LEVEL; NaN without a sigma."""
    known = np.isfinite(sigma)
    return float(100.0 * (left[known].abs() <= corrector.NORMAL * sigma[known]).mean())


def intervals(part: pd.DataFrame, rng: np.random.Generator) -> dict[str, float]:
    """Return the intervals of 95 % of the shares of SGP4's median; part: residuals of one band and lead."""
    draws = np.array(list(_drawn_shares(part, rng)))
    ends = zip(("low", "high"), np.percentile(draws, _INTERVAL, axis=0), strict=True)
    return {f"{name}_{end}": at[k] for end, at in ends for k, name in enumerate(_MODELS)}


def _drawn_shares(part: pd.DataFrame, rng: np.random.Generator) -> Iterator[list[float]]:
    """Yield the shares [%] of draws of weeks and objects."""
    sizes = np.abs(part[["error", *_MODELS]].to_numpy())
    orders = np.argsort(sizes, axis=0, kind="stable")
    for weights in drawn_weights(part, rng):
        sgp4, *left = map(weighted_median, np.take_along_axis(sizes, orders, 0).T, weights[orders].T)
        yield [100.0 * one / sgp4 for one in left]


def judge(folder: Path, name: str, known: Weather, measured: Densities) -> Iterator[pd.DataFrame]:
    """Write the residuals of a season, and yield its scores by learner."""
    season = SEASONS[name]
    tables = {}
    for population in {season.population, season.teachers}:
        sets = catalogues.read([folder / population], latency=season.latency).daily()
        orbits = folder / f"{population}.parquet"
        states = read_table(orbits, "set_states") if orbits.exists() else SCHEMAS["set_states"].empty()
        tables[population] = rows(sets, season, known, measured, states)
    for learner in LEARNERS:
        left = residuals(tables[season.population], tables[season.teachers], season, learner)
        path = folder / "residuals" / name / f"{learner}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        left.to_parquet(path, index=False)
        yield scores(left).assign(test=name, learner=learner)


def main(folder: str, *names: str) -> None:
    """Judge seasons, all or some, by the sets of a folder."""
    known = density.clean(known_weather.read(Path(folder, "SW-All.csv")))
    measured = densities(known)
    tables = [table for name in names or SEASONS for table in judge(Path(folder), name, known, measured)]
    pd.concat(tables).to_csv(Path(folder, "scores.tsv"), sep="\t", index=False)


# The processes that learn the parts of a corrector read this file, too.
if __name__ == "__main__":
    main(*sys.argv[1:])
