"""The mornings of an object that is known by its public sets.

On each it is predicted as `opml predict` does, by the sets and the weather that were public then. What
earlier mornings predicted is judged by the orbit inside the newest set, at its epoch; without one by the set
itself.
"""

from collections.abc import Callable, Mapping, MutableMapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.dynamics.ensemble import Arcs
from opml.element_sets import catalogue as catalogues, improve, trained_model
from opml.element_sets.inside import inside_sizes
from opml.element_sets.inside.inside_forces import ON_ALL_CORES
from opml.element_sets.inside.orbit_prediction import OrbitInside
from opml.element_sets.inside.past_orbits import Calibration
from opml.element_sets.prediction import Prediction, PublicMorning
from opml.element_sets.set_errors import OLDEST
from opml.environment import known_weather
from opml.ephemerides.along_track_shift import LEAST_EPOCHS
from opml.ephemerides.paths import Paths
from opml.interop import ccsds, oem
from opml.interop.element_sets import known_sets, mean_elements, sgp4_errors
from opml.interop.element_sets.element_set import ElementSet, seconds_since
from opml.mornings import outcomes, verdicts
from opml.mornings.candidates import STEP
from opml.mornings.days import MorningResult, WatchedObject
from opml.mornings.outcomes import DO_NOT_USE
from opml.mornings.records import Records, below
from opml.mornings.verdicts import SGP4, Verdict
from opml.mornings.watched_object import MorningPlan
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import DOUBT, SCHEMAS, SIGMA_STATE, SPREAD, STATE

REACH = 90.0  # days before the first morning of a job from which on sets count

_MINUTES = len("2016-09-28T12:09")
_SIZES = SIGMA_STATE[:3]  # standard deviations of positions


PublicOn = Callable[[str], PublicMorning]
"""Returns what was public on a date (UTC text), improved. Raises InputError as `improve.read`."""


def read(
    paths: Sequence[FilePath],
    weather: str,
    *,
    since: float,
    propagator: Callable[..., Arcs] = ON_ALL_CORES,
    kept: MutableMapping[str, Calibration] | None = None,
) -> PublicOn:
    """Read the public sets of all objects of a run and the weather, on the mornings of a job.

    weather: OBSERVED, the packaged one, or a CSSI file; since: modified Julian day (UTC)
    kept: calibrations of orbits inside sets of its mornings and of earlier ones, as of `PublicMorning`

    Raises InputError for unreadable files.
    """
    whole = catalogues.read(paths, leave_out_damaged=True)
    sets = whole.take(np.flatnonzero(whole.table["t"].to_numpy() >= since - REACH))
    measured, model, shared = known_weather.read(weather), trained_model.read(), {} if kept is None else kept

    @lru_cache(maxsize=1)  # all objects have one morning before any has the next
    def public_on(date: str) -> PublicMorning:
        known = improve.public_on(date, sets, known_weather.known_on(date, measured, weather))
        better = improve.improve(known, model, progress=lambda line: None)
        return PublicMorning(known, better, weather, known_sets.LATENCY, propagator, shared)

    return public_on


def of_sets(plan: MorningPlan, public_on: PublicOn, history: Sequence[ElementSet]) -> WatchedObject:
    """Return an object of public sets on its mornings; history: all its sets, by epoch.

    What it predicted is judged by later sets, which are some days old.
    """
    known = [one.made for one in known_sets.since(plan.epoch, history)]
    first = min((t for t in known if t >= 0.0), default=0.0)
    return WatchedObject(
        plan, plan.max_days + OLDEST, first, max(known), {}, partial(_morning, plan, public_on, history)
    )


def _morning(
    plan: MorningPlan, public_on: PublicOn, history: Sequence[ElementSet], records: Records, now: float
) -> MorningResult:
    """Return what the morning at a time [s] leaves; records: of earlier ones."""
    (date,) = ccsds.utc_texts(plan.epoch, np.array([now]))
    row = {"morning": now, "i": -1, "t_i": np.nan, "model": "", "burn_t": np.nan}
    try:
        prediction = public_on(date).predict(history, days=plan.max_days)
    except InputError as reason:
        refused = Verdict(DO_NOT_USE, str(reason))
        nothing = {name: outcomes.NOTHING[name] for name in _FIGURES}
        return MorningResult(_left(row, refused), refused, nothing, None)
    later = _later(prediction, plan.epoch, now)
    burns = prediction.manoeuvres
    judged = _without_burns(_judged(later, records), burns, now)
    past = _without_burns(below([records.judged, judged], "judged"), burns, now)
    start = pd.DataFrame({"track": [later["j"]], "t": [later["t_set"]]})
    verdict = verdicts.verdict(past, start, now=now)
    if prediction.burns:
        shown = f"its sets show a burn, the last about {prediction.burns[-1][:_MINUTES]}Z"
        verdict = replace(verdict, reason=f"{verdict.reason}; {shown}")
    row |= {"i": later["j"], "t_i": later["t_set"], "model": prediction.model}
    paths = _paths(prediction, later["j"], now, days=plan.max_days)
    days, new = np.arange(1.0, plan.max_days + 1e-9), len(judged["j"].unique())
    figures = {
        "tracks": new,
        "converged": new,
        "late": 0,
        **outcomes.orbit(prediction.ephemeris.states[0]),
        "expected": outcomes.expected(days, prediction.sigmas(DAY * days)),
    }

    def write(path: Path, name: str) -> None:
        oem.write(path, [replace(prediction.ephemeris, name=name)], epoch=date)

    left = _left(row, verdict, judged, [paths])
    return MorningResult(left, verdict, figures, None if verdict.word == DO_NOT_USE else write)


def history_of(
    histories: Mapping[int, Sequence[ElementSet]], number: int | None, file: FilePath
) -> Sequence[ElementSet]:
    """Return the sets of an object among those of files, the first of which is named.

    number: its catalogue number; None: there is only one object

    Raises InputError where there are no such sets.
    """
    chosen = next(iter(histories)) if number is None and len(histories) == 1 else number
    if chosen is None or chosen not in histories:
        expected = "a number that names the object" if chosen is None else f"object {chosen}"
        there = ", ".join(map(str, [*histories][:_TOLD])) + (", ..." if len(histories) > _TOLD else "")
        raise InputError(f"{file}: expected {expected}, got {there or 'no set'}")
    return histories[chosen]


_TOLD = 5  # objects in an error
_FIGURES = ("tracks", "converged", "late", "height_km", "inclination_deg", "expected")


def _left(
    row: Mapping[str, Any], verdict: Verdict, judged: pd.DataFrame | None = None, paths: Sequence[Paths] = ()
) -> Records:
    """Return the records of a morning with its row of the table `issued`, whose sizes stand in its paths."""
    issued = pd.DataFrame([{**dict.fromkeys(SCHEMAS["issued"].names, np.nan), **row}])
    rows = SCHEMAS["judged"].empty() if judged is None else judged
    return Records(SCHEMAS["kept_estimates"].empty(), rows, issued.assign(verdict=verdict.word), list(paths))


def _later(prediction: Prediction, epoch: str, now: float) -> dict[str, Any]:
    """Return what judges what was predicted before: j, t_j, t_known, DOUBT and a GCRF state.

    With t_set, the epoch of the newest set; epoch: UTC text from which times count; now: the morning [s]
    """
    satellite = prediction.published
    (t_set,) = seconds_since(epoch, [satellite])
    if isinstance(prediction.inside, OrbitInside):
        inside = prediction.inside.now
        begin = inside.orbit.begin_again(inside.numbers)
        t, state = now + begin.t - inside.forces.time(prediction.date), begin.state
        doubt = inside_sizes.at_epoch(satellite)
    else:
        t, state = t_set, mean_elements.states(satellite, epoch=epoch, t=np.array([t_set]))[0]
        doubt = sgp4_errors.usual_sigmas(satellite, np.zeros(1))[0]
    return {
        "j": int(t_set),
        "t_set": float(t_set),
        "t_j": float(t),
        "t_known": now,
        **dict(zip(DOUBT, doubt, strict=True)),
        **dict(zip(STATE, state, strict=True)),
    }


def _judged(later: Mapping[str, Any], records: Records) -> pd.DataFrame:
    """Return rows of the table `judged`: what earlier mornings predicted against the newest set's orbit."""
    if later["j"] in records.judged["j"].to_numpy():
        return SCHEMAS["judged"].empty()
    parts = []
    for one in records.paths:
        t, at = one.table["t_j"].to_numpy(), later["t_j"]
        if not t[0] <= at <= t[-1]:
            continue
        states = {name: np.array([value]) for name, value in later.items() if name != "t_set"}
        states |= {"i": np.array([one.start])} | dict.fromkeys(SPREAD, np.zeros(1))
        sizes = {name: np.interp(at, t, one.table[name]) for name in _SIZES}
        rows = pd.DataFrame(one.differences(states)).assign(
            model=one.models, **dict.fromkeys(SIGMA_STATE, np.nan)
        )
        # Of the model that was issued, the first, sizes were stated.
        rows.loc[0, _SIZES] = [*sizes.values()]
        parts.append(rows)
    return below(parts, "judged")[SCHEMAS["judged"].names]


def _without_burns(judged: pd.DataFrame, burns: Sequence[Manoeuvre], now: float) -> pd.DataFrame:
    """Return rows without those of times after a burn that was not known when they were predicted.

    burns: times from `now`, the morning [s]
    """
    crossed = np.zeros(len(judged), dtype=bool)
    for one in burns:
        was_unknown = judged["morning"] < now + one.counts_from
        crossed |= (was_unknown & (judged["t_j"] >= now + one.t)).to_numpy()
    return judged[~crossed]


def _paths(prediction: Prediction, set_number: int, now: float, *, days: float) -> Paths:
    """Return the ephemerides of the prediction and of SGP4 from the newest set, with sizes of errors."""
    t = STEP * np.arange(max(int(DAY * days / STEP) + 1, LEAST_EPOCHS))
    states = prediction.states(t)
    by_sgp4 = mean_elements.states(prediction.published, epoch=prediction.date, t=t)
    columns = {"morning": now, "i": set_number, "t_i": now, "t_j": now + t}
    table = pd.DataFrame(columns | dict(zip(STATE, states.T, strict=True)) | dict.fromkeys(SPREAD, 0.0))
    table = table.assign(**dict(zip(_SIZES, prediction.sigmas(t).T, strict=True)))
    table[f"e_y_{prediction.model}"] = 0.0
    if prediction.model != SGP4:
        table[f"e_y_{SGP4}"] = in_rsw(states - by_sgp4, states)[:, 1]
    return Paths(table)
