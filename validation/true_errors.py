"""The paper's experiment on a real catalogue: learns SGP4's errors by the orbits inside later sets.

    python -m validation.true_errors STATES SETS WEATHER BEGIN CUT

STATES is what `opml orbit SETS -o states.parquet` wrote of some objects, SETS a file of element sets of these
and others, WEATHER a CSSI file; BEGIN and CUT are UTC texts. On mornings from BEGIN on, SGP4 of the newest
set is held against the orbit inside the set that is nearest to morning and lead, at its epoch. Half of the
objects teach, up to CUT. Lines tell P_ML [%] by component, learner and list of variables, with intervals of
95 % over weeks and objects: of a fifth of the rows drawn at random, of the same objects after CUT, and of the
others then. Errors count in medians of their band and lead, so that all bands count. Nearly all epochs are at
the ascending node, where errors have a mean: `median` takes off that of each band and lead.
"""

import sys
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import pandas as pd

from opml.base.seeds import derive
from opml.element_sets import catalogue as catalogues
from opml.element_sets import corrector_trial, density, features, set_errors
from opml.element_sets.catalogue import ElementCatalogue, modified_julian_day
from opml.element_sets.corrector_scores import drawn_weights
from opml.element_sets.density import LearnedAir
from opml.element_sets.features import FEATURES
from opml.element_sets.training import FIRST_DAY
from opml.environment import known_weather
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import elements_epoch, seconds_since
from opml.learning.models import boosting, svr
from opml.learning.models.training_inputs import Training, subsample
from opml.orbits.elements import bent_rsw
from opml.tables import STATE, read_table

SEED = 42
_EPOCH = "2000-01-01T12:00:00"  # from which times count
_COMPONENTS = ("r", "s", "w")
_INTERVAL = (2.5, 97.5)
_TESTED = 0.2  # part of the rows that the random split keeps back
_SVR_ROWS = 8000
_CLIP = 5.0  # standard deviations within which the variables of an SVR are held
_TREES = boosting.BoostingSettings(kind=boosting.KIND, trees=150, leaves=31, learning_rate=0.08, min_rows=100)

GEOMETRY = tuple(
    f"{wave}_{count}_{angle}"
    for angle in ("latitude", "greenwich", "sun", "moon")
    for count in (1, 2)
    for wave in ("sin", "cos")
)
"""Waves of the argument of latitude, and of the node's distance from Greenwich, Sun and Moon."""

KNOWN = tuple(f"{of}_{axis}" for of in ("newest", "before") for axis in _COMPONENTS)
"""Errors of SGP4 at the epoch of the newest set, by the orbit inside it: of that set and the one before."""

VARIABLES = {"sets": (*FEATURES, *GEOMETRY), "orbits, too": (*FEATURES, *GEOMETRY, *KNOWN)}


def rows(sets: ElementCatalogue, inside: np.ndarray, air: LearnedAir, mornings: np.ndarray) -> pd.DataFrame:
    """Return the rows of `features.build` with GEOMETRY, KNOWN and the true errors r, s, w [m], where known.

    inside: (sets, 6) GCRF states of orbits at the epochs of sets, NaN where unknown
    """
    pairs = set_errors.build(sets, mornings)
    judge = set_errors.find(sets, mornings)[1]
    made = features.build(sets, pairs, air).assign(judge=judge)
    own = made[made["is_fit"] & (judge >= 0)].reset_index(drop=True)
    return with_true_errors(own, sets, inside)


def with_true_errors(own: pd.DataFrame, sets: ElementCatalogue, inside: np.ndarray) -> pd.DataFrame:
    """Return rows with GEOMETRY, KNOWN and r, s, w [m], where all are known; arguments as of `rows`."""
    is_known = np.isfinite(inside).all(axis=1)
    number, newest, judge = sets.table["number"].to_numpy(), own["newest"].to_numpy(), own["judge"].to_numpy()
    before = np.maximum(newest - 1, 0)
    usable = is_known[newest] & is_known[judge] & (before < newest) & (number[before] == number[newest])
    own, newest, before, judge = own[usable], newest[usable], before[usable], judge[usable]
    flown = _flown(sets, newest, judge)
    errors = {
        "": bent_rsw(flown[:, :3], inside[judge]),
        "newest_": bent_rsw(_flown(sets, newest, newest)[:, :3], inside[newest]),
        "before_": bent_rsw(_flown(sets, before, newest)[:, :3], inside[newest]),
    }
    columns = {f"{of}{axis}": off[:, k] for of, off in errors.items() for k, axis in enumerate(_COMPONENTS)}
    return own.assign(**columns, **_geometry(flown, sets.table["t"].to_numpy()[judge]))


def _flown(sets: ElementCatalogue, of: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return GCRF states (n, 6) by SGP4 of sets (n,) at the epochs of others (n,)."""
    t = seconds_since(_EPOCH, sets.satellites)
    states = np.empty((len(of), 6))
    for one, members in pd.Series(of).groupby(of).indices.items():
        states[members] = mean_elements.states(sets.satellites[one], epoch=_EPOCH, t=t[at[members]])
    return states


def _geometry(states: np.ndarray, mjd: np.ndarray) -> dict[str, np.ndarray]:
    """Return GEOMETRY of GCRF states (n, 6) at modified Julian days (n,), to a degree or so."""
    position, pole = states[:, :3], np.cross(states[:, :3], states[:, 3:])
    node = np.arctan2(pole[:, 0], -pole[:, 1])
    ascending = np.column_stack([np.cos(node), np.sin(node), np.zeros(len(node))])
    ahead = np.cross(pole, ascending)
    across = np.sum(position * ahead, axis=1) / np.linalg.norm(pole, axis=1)
    days = mjd - 51544.5
    angles = {
        "latitude": np.arctan2(across, np.sum(position * ascending, axis=1)),
        "greenwich": node - np.radians(280.46 + 360.9856474 * days),
        "sun": node - np.radians(280.46 + 0.9856474 * days),
        "moon": node - np.radians(218.32 + 13.176396 * days),
    }
    waves = {"sin": np.sin, "cos": np.cos}
    return {
        name: waves[name.split("_")[0]](int(name.split("_")[1]) * angles[name.split("_")[2]])
        for name in GEOMETRY
    }


def scores(own: pd.DataFrame, cut: float) -> Iterator[dict[str, object]]:
    """Yield the rows of the table; own: of `rows`, cut: modified Julian day."""
    half = corrector_trial.half_of(own["number"].to_numpy(), seed=SEED)
    is_drawn = derive(SEED, "random split").random(len(own)) < _TESTED
    is_early, is_later = (own["judged"] <= cut).to_numpy(), (own["morning"] > cut).to_numpy()
    taught = is_early & (half == 0) & ~is_drawn
    tests = {
        "random split": is_early & (half == 0) & is_drawn,
        "later weeks": is_later & (half == 0),
        "other objects, later": is_later & (half == 1),
    }
    cells = own[taught].groupby(["band", "lead"])[[*_COMPONENTS]]
    keys = pd.MultiIndex.from_frame(own[["band", "lead"]])
    sizes, medians = (table.reindex(keys).to_numpy() for table in (cells.apply(_median_size), cells.median()))
    for k, component in enumerate(_COMPONENTS):
        error = own[component].to_numpy() / sizes[:, k]
        predicted = {("median", ""): medians[:, k] / sizes[:, k]}
        for (variables, names), (learner, fit) in product(VARIABLES.items(), _LEARNERS.items()):
            x = own[list(names)].to_numpy()
            predicted[learner, variables] = fit(Training(x[taught], error[taught], names, SEED), x)
        for (learner, variables), values in predicted.items():
            judged = own[["number", "morning"]].assign(error=error, left=error - values).dropna()
            yield {"component": component, "learner": learner, "variables": variables} | {
                name: _p_ml(judged[members[judged.index]]) for name, members in tests.items()
            }
    yield {"component": "rows", **{name: str(members.sum()) for name, members in tests.items()}}


def _median_size(errors: pd.DataFrame) -> pd.Series:
    return errors.abs().median()


def _p_ml(rows: pd.DataFrame) -> str:
    """Return P_ML [%] of rows with an error and what is left of it, with its interval."""
    error, left = rows["error"].abs().to_numpy(), rows["left"].abs().to_numpy()
    draws = [100.0 * (left @ w) / (error @ w) for w in drawn_weights(rows, derive(SEED, "weeks and objects"))]
    low, high = np.percentile(draws, _INTERVAL)
    return f"{100.0 * left.sum() / error.sum():.0f} ({low:.0f}-{high:.0f})"


def _by_svr(training: Training, x: np.ndarray) -> np.ndarray:
    """Return the predictions of rows (n, variables) by the paper's regression of a sample."""
    sample = subsample(len(training.y), _SVR_ROWS, derive(training.seed, "rows"))
    reach = _CLIP * training.x.std(axis=0)
    low, high = training.x.mean(axis=0) - reach, training.x.mean(axis=0) + reach
    scale = float(np.sqrt(2.0 * x.shape[1]))
    settings = svr.SvrSettings(kind=svr.KIND, kernel_scale=scale, c=1.0, epsilon=0.1, tol=1e-3)
    rows = Training(
        np.clip(training.x[sample], low, high), training.y[sample], training.variables, training.seed
    )
    return svr.fit(rows, settings).predict(np.clip(x, low, high))


def _by_trees(training: Training, x: np.ndarray) -> np.ndarray:
    return boosting.fit(training, _TREES).predict(x)


_LEARNERS = {"SVR": _by_svr, "trees": _by_trees}


def main(arguments: Sequence[str]) -> None:
    """Print the table."""
    states, path, weather, begin, cut = arguments
    sets = catalogues.read([path]).daily()
    known = read_table(states, "set_states").set_index(["number", "utc"])[[*STATE]]
    epochs_of_sets = [elements_epoch(one) for one in sets.satellites]
    inside = known.reindex(pd.MultiIndex.from_arrays([sets.table["number"], epochs_of_sets])).to_numpy()
    first, last = modified_julian_day(begin), sets.table["t"].max()
    measured = density.clean(known_weather.read(weather))
    air = density.learned_air(measured, first=FIRST_DAY, end=first)
    own = rows(sets, inside, air, np.arange(first, last))
    pd.DataFrame(scores(own, modified_julian_day(cut))).to_csv(sys.stdout, sep="\t", index=False)


if __name__ == "__main__":
    main(sys.argv[1:])
