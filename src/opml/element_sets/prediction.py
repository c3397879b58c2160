"""Where an object will be by its public element sets, and how surely: the improved set, flown by SGP4.

    made = prediction.predict(["sets.tle"], days=7.0)
    made.state("2026-07-18T00:00:00"), made.covariance("2026-07-18T00:00:00")
    made.to_oem("mine.oem")

Along the track the sigma is the corrector's, times how far the object's own past left it, and larger after a
geomagnetic storm; radially and across it is measured on that past. A short past counts against what is usual
at that height.
"""

import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.element_sets import catalogue as catalogues
from opml.element_sets import density, improve, model, ways
from opml.element_sets.catalogue import ElementCatalogue, modified_julian_day
from opml.environment import nrlmsis
from opml.environment.space_weather import INTERVALS
from opml.interop import fixes_csv, tdm
from opml.interop.element_sets import mean_elements, rewriting
from opml.interop.element_sets.element_set import ElementSet, changed, elements_epoch
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import contents
from opml.interop.orbit_from_files import is_orbit
from opml.interop.predicted_orbit import LEADS, PredictedOrbit
from opml.orbits.elements import bent_rsw
from opml.orbits.rsw_covariance import rates, rsw_covariances

MORNINGS = 12
"""Mornings before the date whose predictions tell an object's own sizes."""

USUAL = 8.0
"""Predictions that err as the corrector says that an object's own count against."""

USUAL_SIZES = 2.0
"""Errors of the usual size that an object's own count against, axis by axis and lead by lead."""

FEWEST = 4
"""Least number of an object's own predictions where nothing is usual: eccentric, deep space, below 300 km."""

UNSEEN = {"r": 100.0, "s": 500.0, "w": 160.0}
"""What sets err alike [m], so that none shows it in another: by precise orbits of Sentinel-3A and Jason-3."""

STORM = 80.0
"""Daily mean ap from which on storms of the last days more than double the variance along the track.

Of what improved sets left of 749 objects on 523 mornings of 2022-23 and 2025, intervals of 90 % held 93 %
after days up to an ap of 50, and 83 % above; with this 93 and 92 %.
"""

STORM_DAYS = 3
"""Days before the date whose storms count."""

_EDGES = 1e3 * np.array([400.0, 500.0, 600.0, 700.0])  # [m]
# Of SGP4 in later sets, 68 % of 975 objects of 2026 that look passive, at LEADS by band of height [m].
_USUAL = {
    "r": [
        [60.0, 120.0, 380.0, 690.0, 1020.0],
        [40.0, 80.0, 240.0, 410.0, 570.0],
        [40.0, 80.0, 230.0, 370.0, 520.0],
        [35.0, 65.0, 190.0, 300.0, 420.0],
        [25.0, 50.0, 150.0, 240.0, 320.0],
    ],
    "s": [
        [1000.0, 4200.0, 41e3, 125e3, 261e3],
        [300.0, 1200.0, 9600.0, 28e3, 58e3],
        [200.0, 650.0, 3800.0, 11e3, 24e3],
        [150.0, 450.0, 1900.0, 4700.0, 9000.0],
        [40.0, 120.0, 390.0, 850.0, 1700.0],
    ],
    "w": [
        [40.0, 40.0, 90.0, 140.0, 210.0],
        [20.0, 30.0, 80.0, 125.0, 170.0],
        [20.0, 40.0, 100.0, 160.0, 220.0],
        [25.0, 40.0, 120.0, 200.0, 280.0],
        [30.0, 90.0, 280.0, 470.0, 660.0],
    ],
}
_TOLD = 10
_GROSS = 4.0  # sigmas that a past error counts at most: some are burns
_MINUTE = 60.0
_TURNING = 0.5  # of the free part of the velocity along the track: of the rate times the radial sigma
_REACH = 0.5  # of a set that judges from the time predicted [d]


@dataclass(frozen=True, eq=False)
class Prediction(PredictedOrbit):
    """An object from the date on when its newest set was known.

    past: as `improve.Improved.past`, of an object whose set nothing improves those of SGP4

    improved, published: the newest set with better numbers, and as it was; how: row of the table
    `improved_sets`; sizes: by lead [d] r, s, w, standard deviations of the prediction, and sgp4, that of the
    published set along the track [m]; better: the set as it is written.
    """

    improved: Satrec
    published: Satrec
    how: pd.Series
    sizes: pd.DataFrame
    better: rewriting.Better

    def _flown(self, t: np.ndarray) -> np.ndarray:
        states = mean_elements.states(self.improved, epoch=self.date, t=t)
        if not np.isfinite(states).all():
            (when,) = self._texts(t[~np.isfinite(states).all(axis=1)][:1])
            raise InputError(f"predict: {self.identity} decays by SGP4 before {when}: give less --days")
        return states

    def sigmas(self, t: np.ndarray) -> np.ndarray:
        """Return standard deviations (n, 3) in RSW [m] at times (n,) [s since the date]."""
        return np.stack([np.interp(t / DAY, self.sizes.index, self.sizes[axis]) for axis in "rsw"], axis=1)

    def covariances(self, t: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Return covariances (n, 6, 6) in RSW [m, m/s] at times (n,) [s since the date].

        What is free of the velocity errs as the position does times the rate of the orbit.
        """
        position, rate = self.sigmas(t), rates(states)
        velocity = rate[:, None] * position[:, [0, 0, 2]] * [1.0, _TURNING, 1.0]
        return rsw_covariances(np.hstack([position, velocity]), rate)

    def expected(self) -> pd.DataFrame:
        """Return the table `expected_errors`: of the prediction in RSW, and of SGP4 along the track [m]."""
        leads = [lead for lead in LEADS if lead <= self.days]
        names = {"s": "along_track", "r": "radial", "w": "cross_track", "sgp4": "sgp4_along_track"}
        rows = self.sizes.loc[leads, [*names]].rename(columns=names)
        rows.insert(0, "utc", self._texts(DAY * np.array(leads, float)))
        return rows.rename_axis("lead").reset_index()

    @property
    def remark(self) -> str:
        """What a message says of it."""
        return f"{self.way}, flown by SGP4"

    @property
    def way(self) -> str:
        """What was used, in words."""
        of = f" from {self.how['population']}" if self.how["population"] else ""
        names = {
            ways.LEARNED: f"set improved by density and what was learned{of}",
            ways.DENSITY: "set improved by the density ahead",
            ways.UNCHANGED: "set as published",
        }
        return names[self.how["applied"]]

    @property
    def reason(self) -> str:
        """Why that was used, in words."""
        if not self.how["why"]:
            return "of all ways it left least of the object's own predictions of 20 mornings"
        return str(self.how["why"])


def predict(
    sets: FilePath | Sequence[FilePath],
    *,
    days: float = 7.0,
    object: str | int | None = None,
    date: str | None = None,
    weather: FilePath = "OBSERVED",
    catalogue: Iterable[FilePath] = (),
    trained: FilePath | None = None,
    progress: improve.Progress = lambda line: None,
) -> Prediction:
    """Predict an object from its public element sets.

    sets: a file or folder, or several, of TLEs or OMMs
    days: how long, 7 at most, as far as errors are known
    object: name, designator or number, where the files have several objects
    date: UTC text; None: when the newest set was known
    weather: OBSERVED, the packaged weather, or a CSSI file
    catalogue: files and folders of other objects' sets, with which the corrector compares
    trained: a model of `opml train`; None: that of the package

    Raises InputError for unreadable files, an object that is not there, days out of range and weather that
    ends too early.
    """
    if not 0.0 < days <= LEADS[-1]:
        raise InputError(f"predict: expected more than 0 and at most {LEADS[-1]} days, got {days:g}")
    paths = [sets] if isinstance(sets, (str, os.PathLike)) else list(sets)
    history = _history(paths, None if object is None else str(object))
    newest = history[-1]
    latency = 0.0 if date is None else catalogues.LATENCY
    date = date or _known(newest)
    known = improve.read([*paths, *catalogue], date=date, weather=str(weather), latency=latency)
    better = improve.improve(known, model.read(trained), progress=progress)
    (place,) = np.flatnonzero(better.table["number"] == newest.number)
    how = better.table.iloc[place]
    past = better.past[better.past["number"] == newest.number].reset_index(drop=True)
    rows = np.flatnonzero(known.catalogue.table["number"] == newest.number)
    own = known.catalogue.take(rows)
    errors = errors_of_sets(own, date)
    if past.empty:
        past = errors[["morning", "lead"]].assign(error=errors["s"], left=errors["s"], sigma=np.nan)
    identity = ObjectId.of(newest.name or str(newest.number), newest.designator, str(newest.number))
    published = own.satellites[-1]
    return Prediction(
        identity,
        date,
        days,
        past,
        _basis(past),
        changed(published, how["motion"], how["bstar"]),
        published,
        how,
        _sizes(identity, how, past, errors, _after_storm(known.weather.kp, how["height"])),
        better.sets[place],
    )


def _basis(past: pd.DataFrame) -> str:
    """Return what the sizes of errors rest on, in words."""
    return (
        f"by {len(past)} predictions of the object's own {past['morning'].nunique()} mornings, held against "
        f"later sets; radial and cross-track by {MORNINGS} mornings at most. What objects of that height "
        "usually show counts as eight predictions, and what all sets err alike is added"
    )


def _history(paths: Sequence[FilePath], wanted: str | None) -> list[ElementSet]:
    """Return the sets of one object in the order of their epochs."""
    files = catalogues.find_files(paths)
    for path in files:
        _check_sets(path)
    sets = [one for path in files for one in mean_elements.read_sets(path, damaged=[]) if one.number]
    sets.sort(key=lambda one: (elements_epoch(one.satellite), one.created))
    newest = {one.number: one for one in sets}
    named = {
        number
        for number, one in newest.items()
        if wanted is None or ObjectId(one.name, one.designator, number).is_called(wanted)
    }
    if len(named) != 1:
        there = ", ".join(f"{number} {one.name}".strip() for number, one in sorted(newest.items())[:_TOLD])
        more = ", ..." if len(newest) > _TOLD else ""
        expected = "--object for one of several objects" if wanted is None else f"one object {wanted}"
        raise InputError(f"{paths[0]}: expected {expected}, got {there or 'no set'}{more}")
    return [one for one in sets if one.number in named]


def _check_sets(path: FilePath) -> None:
    """Raise InputError for points and tracks, which a project fits."""
    content = contents(path)
    kinds = {
        "points of an orbit: fit them": is_orbit(content) or fixes_csv.matches(content),
        "tracks: fit them": tdm.matches(content),
    }
    for kind in (kind for kind, is_so in kinds.items() if is_so):
        raise InputError(
            f"{path}: expected element sets, got {kind} in a project, as `opml docs tracks` tells"
        )


def _known(one: ElementSet) -> str:
    """Return when a set was known, in whole seconds of UTC: when it was made, else its epoch."""
    latest = np.datetime64(max(one.created, elements_epoch(one.satellite)), "us")
    return str((latest + np.timedelta64(999_999, "us")).astype("M8[s]"))


def errors_of_sets(catalogue: ElementCatalogue, date: str) -> pd.DataFrame:
    """Return errors of SGP4 from the newest sets of the mornings before a date: morning, lead, r, s, w [m].

    catalogue: of one object

    The later set nearest to morning plus lead judges, at its own epoch, if it is within half a day.
    """
    t, known = (catalogue.table[name].to_numpy() for name in ("t", "known"))
    rows = []
    for morning in modified_julian_day(date) - np.arange(1, MORNINGS + 1):
        newest = int(np.searchsorted(known, morning, side="right")) - 1
        if newest < 0:
            continue
        for lead in LEADS:
            later = int(np.argmin(np.abs(t - morning - lead)))
            if later > newest and abs(t[later] - morning - lead) <= _REACH:
                rows.append(
                    (morning, lead, *_apart(catalogue.satellites[newest], catalogue.satellites[later]))
                )
    return pd.DataFrame(rows, columns=["morning", "lead", *"rsw"]).dropna()


def _apart(flown: Satrec, judge: Satrec) -> tuple[float, float, float]:
    """Return how far SGP4 flies from another set at the epoch of that: outwards, ahead, across [m]."""
    _, *own = judge.sgp4_tsince(0.0)
    _, position, _ = flown.sgp4(judge.jdsatepoch, judge.jdsatepochF)
    r, s, w = 1e3 * bent_rsw(np.array([position]), np.concatenate(own)[None])[0]
    return r, s, w


def _after_storm(kp: np.ndarray, height: float) -> float:
    """Return by how much errors along the track are larger after the last days' geomagnetic activity.

    kp: three-hourly, up to the date
    height: of the object [m]; above the tables of densities drag is too small
    """
    if height > density.HEIGHTS[-1]:
        return 1.0
    ap = nrlmsis.ap_of_kp(kp[-INTERVALS * STORM_DAYS :]).reshape(STORM_DAYS, INTERVALS).mean(axis=1)
    return math.hypot(1.0, ap.max() / STORM)


def _sizes(
    identity: ObjectId, how: pd.Series, past: pd.DataFrame, errors: pd.DataFrame, after_storm: float
) -> pd.DataFrame:
    """Return the sizes of errors by lead, as in `Prediction`.

    errors: of `errors_of_sets`
    after_storm: of `_after_storm`
    """
    is_known = np.isfinite(how[f"sigma_{LEADS[-1]}d"])
    if not is_known and len(errors) < FEWEST:
        raise InputError(
            f"predict: expected a longer history of {identity}, got {len(errors)} predictions that later "
            f"sets judge: nothing else tells its errors ({how['why'] or 'no prediction'})"
        )
    usual = _usual(how["height"])
    sizes = pd.DataFrame({axis: _measured(errors, axis, usual[axis]) for axis in "rsw"})
    sizes["sgp4"] = sizes["s"]
    if is_known:
        factor = _factor(past)
        sigma = factor * np.array([how[f"sigma_{lead}d"] for lead in LEADS[1:]], float)
        correction = np.sqrt([how[f"sgp4_{lead}d"] ** 2 - how[f"sigma_{lead}d"] ** 2 for lead in LEADS[1:]])
        sizes.loc[LEADS[1:], "s"] = sigma
        sizes.loc[LEADS[1:], "sgp4"] = np.hypot(sigma, correction)
        sizes.loc[0, ["s", "sgp4"]] = min(sizes.loc[0, "s"], sizes.loc[1, "s"])
    sizes[["s", "sgp4"]] *= after_storm
    # An orbit that is too low by x gains 3/2 of its rate times x.
    gained = np.gradient(np.maximum.accumulate(sizes["s"]), np.array(LEADS, float)) / DAY
    sizes["r"] = np.hypot(sizes["r"], gained / (1.5 * how["motion"] / _MINUTE))
    for name in sizes:
        unseen = UNSEEN["s" if name == "sgp4" else name]
        sizes[name] = np.hypot(np.maximum.accumulate(sizes[name]), unseen)
    return sizes


def _usual(height: float) -> pd.DataFrame:
    """Return what SGP4 usually errs by in later sets [m], r, s, w by lead, at a height [m]."""
    band = int(np.searchsorted(_EDGES, height, side="right"))
    return pd.DataFrame({axis: values[band] for axis, values in _USUAL.items()}, index=list(LEADS))


def usual_sizes(height: float, lead: int) -> dict[str, float]:
    """Return what SGP4 usually errs by, with what no set shows: r, s, w [m] at a height [m] and lead [d]."""
    usual = _usual(height).loc[lead]
    return {axis: float(np.hypot(usual[axis], UNSEEN[axis])) for axis in "rsw"}


def _measured(errors: pd.DataFrame, axis: str, usual: pd.Series) -> pd.Series:
    """Return root mean squares by lead; the object's own count against USUAL_SIZES of the usual size."""
    squares = (errors[axis] ** 2).groupby(errors["lead"])
    total, count = (of.reindex(usual.index, fill_value=0.0) for of in (squares.sum(), squares.size()))
    found: pd.Series = np.sqrt((total + USUAL_SIZES * usual**2) / (count + USUAL_SIZES))
    return found


def _factor(past: pd.DataFrame) -> float:
    """Return by how much the object's own past errs more than its sigmas, against USUAL that err as these."""
    ratios, counts = np.minimum((past["left"] / past["sigma"]) ** 2, _GROSS**2), _counts(past)
    return float(np.sqrt(((counts * ratios).sum() + USUAL) / (counts.sum() + USUAL)))


def _counts(errors: pd.DataFrame) -> pd.Series:
    """Return what each error counts: those of seven days hardly change from one morning to the next."""
    counts: pd.Series = 1.0 / errors["lead"].clip(lower=1)
    return counts
