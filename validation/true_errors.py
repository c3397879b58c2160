"""The paper's experiment on a real catalogue: learns SGP4's errors by the orbits inside later sets.

    python -m validation.true_errors STATES SETS WEATHER BEGIN CUT

STATES is what `opml orbit SETS -o states.parquet` wrote of some objects, SETS a file of element sets of these
and others, WEATHER a CSSI file; BEGIN and CUT are UTC texts. On mornings from BEGIN on, SGP4 of the newest
set is held against the orbit inside the set that is nearest to morning and lead, at its epoch. Half of the
objects teach, up to CUT. Lines tell P_ML [%] by component and learner, with intervals of 95 % over weeks and
objects: of a fifth of the rows drawn at random, of the same objects on every fifth morning after CUT, and of
the others then. Errors count in medians of their band and lead, so that all bands count. Nearly all epochs
are at the ascending node, where errors have a mean: `median` takes off that of each band and lead. `orbit
inside` is the one inside the newest set, propagated, without learning; a second table has its medians by
band.
"""

import sys
from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.seeds import derive
from opml.benchmark.scores import drawn_weights
from opml.element_sets import catalogue as catalogues, density, features, set_errors
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.density import Air
from opml.element_sets.features import FEATURES
from opml.element_sets.inside import inside_forces
from opml.element_sets.inside.inside_forces import Forces
from opml.element_sets.inside.orbit_inside import LIGHT, Beginning, departing
from opml.element_sets.set_errors import OLDEST
from opml.element_sets.training import FIRST_DAY
from opml.environment import known_weather
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import elements_epoch, seconds_since
from opml.learning.models import boosting, svr
from opml.learning.models.training_inputs import Training, subsample
from opml.orbits.elements import bent_rsw
from opml.tables import STATE, read_table
from validation import catalogue_seasons, public_catalogue

SEED = 42
_EPOCH = "2000-01-01T12:00:00"  # from which times count
_COMPONENTS = ("r", "s", "w")
_INTERVAL = (2.5, 97.5)
_TESTED = 0.2  # part of the rows that the random split keeps back
_EVERY = 5  # mornings, one of which judges
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

VARIABLES = (*FEATURES, *GEOMETRY)


def rows(sets: ElementCatalogue, inside: np.ndarray, air: Air, mornings: np.ndarray) -> pd.DataFrame:
    """Return the rows of `features.build` whose sets have orbits, with GEOMETRY and true errors r, s, w [m].

    inside: (sets, 7) GCRF states of orbits at the epochs of sets and their Cd A/m, NaN where unknown
    """
    judge = set_errors.find(sets, mornings)[1]
    made = features.build(sets, set_errors.build(sets, mornings), air).assign(judge=judge)
    return with_true_errors(made[made["is_fit"] & (judge >= 0)], sets, inside)


def with_true_errors(own: pd.DataFrame, sets: ElementCatalogue, inside: np.ndarray) -> pd.DataFrame:
    """Return rows whose sets have orbits, with GEOMETRY and true errors r, s, w [m]; inside: as of `rows`."""
    is_known = np.isfinite(inside).all(axis=1)
    own = own[is_known[own["newest"]] & is_known[own["judge"]]].reset_index(drop=True)
    judge = own["judge"].to_numpy()
    flown = _flown(sets, own["newest"].to_numpy(), judge)
    off = dict(zip(_COMPONENTS, bent_rsw(flown[:, :3], inside[judge, :6]).T, strict=True))
    return own.assign(**off, **_geometry(flown, sets.table["t"].to_numpy()[judge]))


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


def by_orbits(own: pd.DataFrame, sets: ElementCatalogue, inside: np.ndarray, forces: Forces) -> np.ndarray:
    """Return errors (n, 3) in RSW [m] of propagated orbits inside newest sets; arguments as of `rows`."""
    t = seconds_since(forces.epoch, sets.satellites)
    off = np.empty((len(own), 3))
    for morning, members in own.groupby("morning").indices.items():
        newest, place = np.unique(own["newest"].to_numpy()[members], return_inverse=True)
        judge = own["judge"].to_numpy()[members]
        times = np.unique(t[[*newest, *judge]])
        first, there = np.searchsorted(times, t[newest]), np.searchsorted(times, t[judge])
        last = pd.Series(there).groupby(place).max().to_numpy()
        known = forces.time(f"{epochs.calendar(morning)}T00:00:00") + DAY * (morning % 1.0)
        begins = [
            Beginning(sets.satellites[k], t[k], inside[k, :6], inside[k, 6], LIGHT, known) for k in newest
        ]
        arcs = forces.propagate(times, departing(begins, forces, first=first, last=last))
        states = [arcs.path(k)[at - first[k] - 1] for k, at in zip(place, there, strict=True)]
        off[members] = bent_rsw(np.array(states)[:, :3], inside[judge, :6])
    return off


def scores(own: pd.DataFrame, by_orbits: np.ndarray, cut: float) -> Iterator[dict[str, object]]:
    """Yield the rows of the table.

    own: of `rows`; by_orbits: (n, 3) errors of orbits inside, NaN in rows that do not judge; cut: modified
    Julian day
    """
    half = catalogue_seasons.half_of(own["number"].to_numpy(), seed=SEED)
    is_drawn = derive(SEED, "random split").random(len(own)) < _TESTED
    is_early, is_later = (own["judged"] <= cut).to_numpy(), np.isfinite(by_orbits).all(axis=1)
    taught = is_early & (half == 0) & ~is_drawn
    tests = {
        "random split": is_early & (half == 0) & is_drawn,
        "later weeks": is_later & (half == 0),
        "other objects, later": is_later & (half == 1),
    }
    cells = own[taught].groupby(["band", "lead"])[[*_COMPONENTS]]
    keys = pd.MultiIndex.from_frame(own[["band", "lead"]])
    sizes, medians = (table.reindex(keys).to_numpy() for table in (cells.apply(_median_size), cells.median()))
    x = own[[*VARIABLES]].to_numpy()
    for k, component in enumerate(_COMPONENTS):
        error = own[component].to_numpy() / sizes[:, k]
        training = Training(x[taught], error[taught], VARIABLES, SEED)
        left = {"orbit inside": by_orbits[:, k] / sizes[:, k], "median": error - medians[:, k] / sizes[:, k]}
        left |= {learner: error - fit(training, x) for learner, fit in _LEARNERS.items()}
        for learner, values in left.items():
            judged = own[["number", "morning"]].assign(error=error, left=values).dropna()
            yield {"component": component, "learner": learner} | {
                name: _p_ml(judged[members[judged.index]]) for name, members in tests.items()
            }
    yield {"component": "rows", **{name: str(members.sum()) for name, members in tests.items()}}


def shares(own: pd.DataFrame, by_orbits: np.ndarray) -> pd.DataFrame:
    """Return `public_catalogue.medians` of the orbits inside newest sets; arguments as of `scores`."""
    by_sgp4 = own.rename(columns={axis: f"sgp4_{axis}" for axis in _COMPONENTS})
    flown = by_sgp4.assign(**dict(zip(_COMPONENTS, by_orbits.T, strict=True)))
    return public_catalogue.medians(flown.dropna(subset=[*_COMPONENTS]), public_catalogue.SHARES)


def _median_size(errors: pd.DataFrame) -> pd.Series:
    return errors.abs().median()


def _p_ml(rows: pd.DataFrame) -> str:
    """Return P_ML [%] of rows with an error and what is left of it, with its interval."""
    if rows.empty:
        return "n/a"
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
    states, path, weather, begin, end = arguments
    sets = catalogues.read([path]).daily()
    known = read_table(states, "set_states").set_index(["number", "utc"])[[*STATE, "ballistic"]]
    utc = [elements_epoch(one) for one in sets.satellites]
    inside = known.reindex(pd.MultiIndex.from_arrays([sets.table["number"], utc])).to_numpy()
    first, last, cut = epochs.mjd(begin), sets.table["t"].max(), epochs.mjd(end)
    measured = density.clean(known_weather.read(weather))
    air, _ = density.learned_air(measured, first=FIRST_DAY, end=first)
    own = rows(sets, inside, air, np.arange(first, last))
    judging = np.flatnonzero((own["morning"] > cut) & (np.floor(own["morning"]) % _EVERY == 0))
    errors = np.full((len(own), 3), np.nan)
    forces = inside_forces.read(weather, first=cut - OLDEST, last=last)
    errors[judging] = by_orbits(own.iloc[judging], sets, inside, forces)
    for table in (pd.DataFrame(scores(own, errors, cut)), shares(own, errors)):
        table.to_csv(sys.stdout, sep="\t", index=False)


if __name__ == "__main__":
    main(sys.argv[1:])
