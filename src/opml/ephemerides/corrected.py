"""Corrected ephemerides: a model's word on the errors of predictions, applied on a regular grid of epochs.

From an estimate the assumed model predicts to every epoch of the grid. What the learned model asks for is
computed at those epochs as it was at later tracks. The along-track error that it then tells moves the orbit
(opml.ephemerides.along_track_shift). No truth is needed: all of it is known at t_i.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.predict import mechanism, other_windows, spread
from opml.catalog.predict.prediction import predict
from opml.catalog.predict.sensitivity import sensitivities
from opml.dynamics import force_model
from opml.dynamics.ensemble import Integrator
from opml.dynamics.kernels.surroundings import ForceModel
from opml.ephemerides.along_track_shift import LEAST_EPOCHS, check_smooth, corrected, through
from opml.learning.data import dataset
from opml.learning.data.cleaning import Cleaning
from opml.learning.judge.error_sizes import Sizes
from opml.learning.models.contract import Model
from opml.learning.models.daily_training import Lessons
from opml.learning.models.learners import tables_asked
from opml.orbits.elements import in_rsw
from opml.orbits.rsw_covariance import rates, rsw_covariances
from opml.orbits.sheets import Rso
from opml.tables import SPREAD, STATE, read_metadata, read_table

Spread = Callable[[pd.DataFrame], pd.DataFrame]
"""The `spread` table of pairs."""

TOGETHER = 16
"""Ephemerides made side by side: their arcs fill the lanes of an ensemble, their tables some hundred MB."""

COVARIANCES = [f"cov_{a}_{b}" for k, a in enumerate(STATE) for b in STATE[: k + 1]]
"""Columns of the lower triangle of a state's covariance."""


@dataclass(frozen=True)
class Flight:
    """An RSO under the assumed model, and how it is integrated."""

    model: ForceModel
    rso: Rso
    integrator: Integrator
    threads: int = 1

    @property
    def options(self) -> dict[str, Any]:
        """The same, as what flies arcs in opml.catalog takes it."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def read(cls, files: Any, settings: Mapping[str, Any], *, threads: int) -> Self:
        """What a job's `files` and settings say; raises InputError where one is missing or damaged."""
        return cls(
            force_model.read(files, epoch=settings["epoch"], settings=settings["force_model"]),
            Rso(**settings["rso"]),
            force_model.integrator(settings["integrator"]),
            threads,
        )


@dataclass(frozen=True)
class Longer:
    """Fits over a longer window: the table `estimates`, the window [h]."""

    estimates: pd.DataFrame
    window_hours: float


@dataclass(frozen=True)
class Known:
    """What the catalogue knows of an RSO: the tables at its tracks, and how more is made of them.

    estimates: that table, of fits over window_hours; at_estimates: from `dataset.of_estimates`; long, arc:
    fits over other windows, None where the learner asks for nothing of them; bounds: on Cd, None for any;
    resonances: pairs (k, m); memory_days: of the arcs' Cd; manoeuvres: times [s]; gm [m3/s2].
    """

    estimates: pd.DataFrame
    at_estimates: pd.DataFrame
    window_hours: float
    gm: float
    long: Longer | None = None
    arc: Longer | None = None
    bounds: tuple[float, float] | None = None
    resonances: Sequence[tuple[int, int]] = ()
    memory_days: float = 0.0
    manoeuvres: Sequence[float] = ()


@dataclass(frozen=True)
class Grid:
    """Epochs of ephemerides: multiples of `step` [s], up to max_days after an estimate and to `end` [s]."""

    step: float
    max_days: float
    end: float

    def epochs(self, last: float) -> pd.Series:
        """Epochs [s] by their numbers, up to where an ephemeris from an estimate at `last` [s] reaches."""
        number = np.arange(np.floor(min(last + DAY * self.max_days, self.end) / self.step) + 1.0).astype(int)
        return pd.Series(self.step * number, index=number)


def task(
    files: Any, settings: Mapping[str, Any], *, threads: int
) -> tuple[Flight, Known, pd.DataFrame, Grid]:
    """What a job makes ephemerides with: how arcs fly, what is known, the estimates to start from, the grid.

    Raises InputError as `read` and `departures` do.
    """
    known = read(files, settings)
    until, each = DAY * settings["known_until_days"], settings["from"] == "each"
    step, max_days, duration_days = settings["grid"]
    return (
        Flight.read(files, settings, threads=threads),
        known,
        departures(known, known_until=until, each=each),
        Grid(step, max_days, DAY * duration_days),
    )


def spreading(files: Any, settings: Mapping[str, Any], known: Known, *, threads: int) -> Spread:
    """How a job's `files` and settings tell the `spread` of pairs; futures of the weather are optional."""
    flight = Flight.read(files, {**settings, "force_model": spread.FLATTENED}, threads=threads)
    futures = read_table(files.futures, "futures") if files.futures else None
    return lambda pairs: spread.build(
        estimates=known.estimates, pairs=pairs, futures=futures, **flight.options
    )


def read(files: Any, settings: Mapping[str, Any]) -> Known:
    """What the tables of a job's `files` hold, read as its `settings` say.

    Raises InputError where one is missing, damaged or does not belong to the others.
    """
    estimates = read_table(files.estimates, "estimates")
    gm, mechanism_of = read_metadata(files.gravity_field)["gm"], settings["mechanism"]
    at_estimates = dataset.of_estimates(
        estimates,
        read_table(files.predictions, "predictions"),
        read_table(files.tracking, "tracking"),
        gm=gm,
        cleaning=Cleaning.from_settings(settings["cleaning"]),
    )
    arc_hours, memory_days = settings["arc"]
    told = read_metadata(files.manoeuvres) if files.manoeuvres else {}
    return Known(
        estimates,
        at_estimates,
        settings["window_hours"],
        gm,
        long=_longer(files.get("long_estimates"), mechanism_of["long_window_hours"]),
        arc=_longer(files.get("arc_estimates"), arc_hours),
        bounds=settings["cd_bounds"],
        resonances=mechanism_of["resonances"],
        memory_days=memory_days,
        manoeuvres=[one["t"] for one in told.get("manoeuvres", [])],
    )


def _longer(path: str | None, window_hours: float) -> Longer | None:
    """Fits of a file, if there is one."""
    return Longer(read_table(path, "estimates"), window_hours) if path else None


def departures(known: Known, *, known_until: float, each: bool) -> pd.DataFrame:
    """The estimates that ephemerides start from: the newest usable one up to `known_until` [s].

    With `each` all usable later ones, too. Raises InputError where there is none.
    """
    usable = dataset.may_depart(
        known.estimates, known.at_estimates, manoeuvres=known.manoeuvres, window=HOUR * known.window_hours
    )
    newest = np.flatnonzero(usable & (known.estimates["t"].to_numpy() <= known_until))
    if not newest.size:
        last = f"day {known_until / DAY:g}, the last to learn from"
        raise InputError(f"ephemeris: expected a usable estimate up to {last}, got none")
    later = known.estimates[newest[-1] :][usable[newest[-1] :]]
    return later if each else later[:1]


def build(
    flight: Flight,
    known: Known,
    lessons: Lessons,
    replay: pd.DataFrame,
    starts: pd.DataFrame,
    grid: Grid,
    *,
    spreads: Spread,
    first_morning: float,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `corrected` table: an ephemeris from each of the `starts`, rows of the estimates.

    lessons: the learner as of a morning; replay: that table of it, which sizes are learned from; spreads: how
    far drag and weather may take pairs; first_morning: when the first ephemeris is made [s], later ones with
    what is known at the day's beginning. An ephemeris ends where an arc that it needs does. Raises InputError
    where none reaches anywhere, where a size has no past, and as `correction.check_smooth` does.
    """

    @cache
    def sizes(now: float) -> Sizes:
        return Sizes.learned(replay, now=now)

    def some(chosen: pd.DataFrame) -> Iterator[pd.DataFrame]:
        columns = rows(flight, known, chosen, lessons.variables, grid)
        sparse = columns[columns.groupby("i").cumcount() % _sparse(grid.step) == 0]
        told = sparse[["i", "t_j"]].join(spreads(sparse)[SPREAD])
        for own in reached(columns, (*STATE, *lessons.variables)):
            now = morning(own["t_i"].iloc[0], first=first_morning)
            along = said(own, lessons(now))
            check_smooth(own["t_j"].to_numpy(), along)
            states = moved(own, along)
            turning = _between(own, told[told["i"] == own["i"].iloc[0]]).assign(rate=rates(states))
            covariances = rsw_covariances(sizes(now).sigmas(turning), turning["rate"].to_numpy())
            yield table(own, states, covariances)

    return by_parts(some, starts, grid, progress=progress)


def basis(replay: pd.DataFrame, now: float) -> str:
    """What the covariances of ephemerides as of `now` [s] rest on, in words; replay: that table."""
    past = replay[replay["t_known"] <= now]
    mornings, longest = past["morning"].nunique(), past["duration"].max() / DAY
    return (
        f"covariances from {len(past)} predictions of {mornings} mornings that were over by "
        f"day {now / DAY:g}, up to {longest:.1f} days long"
    )


SPREAD_STEP = 600.0
"""Time between the epochs of an ephemeris that arcs fly to for its spread [s], linear between them."""


def _sparse(step: float) -> int:
    """How many steps [s] of a grid are one of the spread's."""
    return max(1, round(SPREAD_STEP / step))


def _between(own: pd.DataFrame, told: pd.DataFrame) -> pd.DataFrame:
    """Rows of one estimate with the columns of a spread `told` at some of their epochs."""
    reached = told[np.isfinite(told[SPREAD].to_numpy()).all(axis=1)]
    return own.assign(**{name: np.interp(own["t_j"], reached["t_j"], reached[name]) for name in SPREAD})


def morning(t: float, *, first: float = 0.0) -> float:
    """When what an ephemeris from an estimate at `t` [s] is made with is known: its day's beginning.

    Never before `first`, when the first of a series is made.
    """
    return max(first, DAY * float(np.floor(t / DAY)))


def by_parts(
    some: Callable[[pd.DataFrame], Iterator[pd.DataFrame]],
    starts: pd.DataFrame,
    grid: Grid,
    *,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `corrected` table of all `starts`, of which `some` makes the ephemerides of a few.

    Raises InputError where none reaches anywhere.
    """
    found: list[pd.DataFrame] = []
    for begin in range(0, len(starts), TOGETHER):
        chosen = starts.iloc[begin : begin + TOGETHER]
        found += some(chosen)
        if progress:
            progress((begin + len(chosen)) / len(starts))
    if not found:
        least = f"{LEAST_EPOCHS} epochs {grid.step:g} s apart"
        raise InputError(f"ephemeris: expected {least} after an estimate and before the run ends, got fewer")
    return pd.concat(found, ignore_index=True)


def rows(
    flight: Flight, known: Known, starts: pd.DataFrame, variables: Sequence[str], grid: Grid
) -> pd.DataFrame:
    """Predictions from the `starts` to the grid, with the learning variables that a model asks for.

    j is the number of the epoch on the grid. Rows without numbers are where an arc does not reach.
    """
    pairs = _predicted(flight, starts, grid)
    columns = pairs.join(known.at_estimates, on="i")
    columns["duration"] = columns["t_j"] - columns["t_i"]
    for kind in tables_asked(variables):
        if kind not in _BESIDE:
            raise InputError(f"ephemeris: expected a learner that asks for one RSO alone, got the {kind}")
        table = _BESIDE[kind](flight, known, pairs, grid)
        columns = columns.join(table.drop(columns=["i", "j"]))
    return columns


def _predicted(flight: Flight, starts: pd.DataFrame, grid: Grid) -> pd.DataFrame:
    """Predictions of estimates to the grid."""
    arrivals = grid.epochs(starts["t"].iloc[-1])
    return predict(estimates=starts, arrivals=arrivals, max_days=grid.max_days, **flight.options)


def _mechanism(flight: Flight, known: Known, pairs: pd.DataFrame, grid: Grid) -> pd.DataFrame:
    """The `mechanism` table of pairs."""
    if known.long is None:
        raise InputError("ephemeris: expected fits over a longer window, as the learner asks for, got none")
    long, options = known.long.estimates, flight.options | {"bounds": known.bounds}
    long_pairs = _predicted(flight, _of(long, pairs), grid)
    return mechanism.build(
        known.estimates,
        pairs,
        sensitivities(estimates=known.estimates, predictions=pairs, **options),
        long_estimates=long,
        long_predictions=long_pairs,
        long_sensitivities=sensitivities(estimates=long, predictions=long_pairs, **options),
        bounds=known.bounds,
        resonances=known.resonances,
        long_window_hours=known.long.window_hours,
        gm=known.gm,
    )


def _arcs(flight: Flight, known: Known, pairs: pd.DataFrame, grid: Grid) -> pd.DataFrame:
    """The `arcs` table of pairs."""
    if known.arc is None:
        raise InputError("ephemeris: expected fits over another window, as the learner asks for, got none")
    return other_windows.build(
        predictions=pairs,
        arc_estimates=known.arc.estimates,
        arc_predictions=_predicted(flight, _of(known.arc.estimates, pairs), grid),
        memory_days=known.memory_days,
        manoeuvres=known.manoeuvres,
        window=HOUR * known.arc.window_hours,
        **flight.options,
    )


_BESIDE = {"mechanism": _mechanism, "arcs": _arcs}
"""How the tables that a learner asks for are made of pairs."""


def _of(estimates: pd.DataFrame, pairs: pd.DataFrame) -> pd.DataFrame:
    """The estimates of the same tracks that pairs start from."""
    return estimates[estimates["track"].isin(pairs["i"].unique())]


def reached(columns: pd.DataFrame, names: Sequence[str]) -> Iterator[pd.DataFrame]:
    """The rows of each estimate up to its first one without numbers in the columns `names`."""
    lost = ~np.isfinite(columns[list(names)].to_numpy()).all(axis=1)
    for own in columns.groupby("i", sort=True).indices.values():
        found = own[np.cumsum(lost[own]) == 0]
        if len(found) >= LEAST_EPOCHS:
            yield columns.iloc[found]


def said(own: pd.DataFrame, model: Model) -> np.ndarray:
    """What a model says of e_y (n,) [m]; own: `rows` of one estimate with the model's variables."""
    return model.predict(own[list(model.variables)].to_numpy())


def moved(own: pd.DataFrame, along: np.ndarray) -> np.ndarray:
    """States (n, 6) GCRF [m, m/s] of one ephemeris, `rows` of an estimate, corrected by e_y (n,) [m]."""
    return corrected(own["t_j"].to_numpy(), np.ascontiguousarray(own[STATE]), along)


def table(own: pd.DataFrame, states: np.ndarray, covariances: np.ndarray) -> pd.DataFrame:
    """Rows of the `corrected` table: `rows` of one estimate, its states (n, 6) and covariances (n, 6, 6)."""
    columns = {"i": own["i"].to_numpy(), "t_i": own["t_i"].to_numpy(), "t": own["t_j"].to_numpy()}
    predicted = {f"{name}_predicted": own[name].to_numpy() for name in STATE}
    triangle = covariances[:, *np.tril_indices(6)].T
    return pd.DataFrame(
        columns
        | dict(zip(STATE, states.T, strict=True))
        | predicted
        | dict(zip(COVARIANCES, triangle, strict=True))
    )


def held_against(ephemeris: pd.DataFrame, estimates: pd.DataFrame) -> pd.DataFrame:
    """What one ephemeris, rows of a `corrected` table, is off from the estimates of later tracks.

    Columns: duration [s]; before_*, after_*: predicted and corrected less estimated position in RSW of the
    estimate [m]; sigma_*: standard deviations by the ephemeris [m]. Estimates that did not converge are left
    out.
    """
    t = ephemeris["t"].to_numpy()
    later = estimates[estimates["converged"] & estimates["t"].between(t[0], t[-1])]
    at, known = later["t"].to_numpy(), np.ascontiguousarray(later[STATE])
    found = {"duration": at - ephemeris["t_i"].iloc[0]}
    for when, suffix in (("before", "_predicted"), ("after", "")):
        states = through(t, ephemeris[[f"{name}{suffix}" for name in STATE]].to_numpy())(at)
        off = in_rsw(states - known, known)
        found |= {f"{when}_{axis}": off[:, k] for k, axis in enumerate("xyz")}
    for axis in "xyz":
        found[f"sigma_{axis}"] = np.interp(at, t, np.sqrt(ephemeris[f"cov_{axis}_{axis}"].to_numpy()))
    return pd.DataFrame(found)
