"""Where an object will be by its public element sets, and how surely: the improved set, propagated by SGP4.

    made = prediction.predict(["sets.tle"], days=7.0)
    made.state("2026-07-18T00:00:00"), made.covariance("2026-07-18T00:00:00")
    made.to_oem("mine.oem")

Along the track the sigma is the corrector's, times how far the object's own past left it, and larger after a
geomagnetic storm; radially and across it is measured on that past. A short past counts against what is usual
at that height.
"""

import math
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.progress import Progress
from opml.element_sets import catalogue as catalogues
from opml.element_sets import corrector, density, improve, known_sets, trained_model, weighting
from opml.element_sets.catalogue import ElementCatalogue, modified_julian_day
from opml.element_sets.improve import Improved
from opml.element_sets.inside import orbit_prediction
from opml.element_sets.inside.inside_sizes import lower
from opml.element_sets.inside.orbit_prediction import OrbitInside
from opml.environment import nrlmsis
from opml.environment.space_weather import INTERVALS
from opml.interop import ccsds
from opml.interop.element_sets import mean_elements, rewriting, sgp4_errors
from opml.interop.element_sets.burns_in_sets import KnownSet, burns_among
from opml.interop.element_sets.element_set import ElementSet, changed, elements_epoch, seconds_since
from opml.interop.predicted_orbit import LEADS, PredictedOrbit
from opml.orbits.density_error import DensityErrors
from opml.orbits.elements import bent_rsw

MORNINGS = 12  # mornings before the date whose predictions tell an object's own sizes, radial and cross-track

ALONG_MORNINGS = 20
"""Mornings before the date whose predictions tell an object's own sigma along the track: more would hide a
burn, or a month of storms."""

USUAL = 8.0  # predictions that err as the corrector says that an object's own count against

USUAL_SIZES = 2.0
"""Errors of the usual size that an object's own count against, axis by axis and lead by lead."""

FEWEST = 4
"""Least number of an object's own predictions where nothing is usual: eccentric, deep space, below 300 km."""

STORM = 80.0
"""Daily mean ap from which on storms of the last days more than double the variance along the track.

Of what improved sets left of 749 objects on 523 mornings of 2022-23 and 2025, intervals of 90 % held 93 %
after days up to an ap of 50, and 83 % above; with this 93 and 92 %.
"""

STORM_DAYS = 3  # days before the date whose storms count
BURNED = 20.0  # days before the date whose burns count: those of the mornings that tell sizes of errors

LOW = 600e3
"""Height below which drag outweighs what else changes the size of an orbit: B* below 0 is thrust [m]."""

_FEW_JUDGED = f"fewer than {FEWEST} of its predictions have a later set to judge them"
_GROSS = 4.0  # sigmas that a past error counts at most: some are burns
_MINUTE, _DAY = 60.0, len("2016-09-28")
_REACH = 0.5  # of a set that judges from the time predicted [d]


@dataclass(frozen=True, eq=False, repr=False)
class Prediction(PredictedOrbit):
    """An object from the date on when its newest set was known.

    past: as `improve.Improved.past`, of an object whose set nothing improves those of SGP4

    improved, published: the newest set with better numbers, and as it was; how: row of the table
    `improved_sets`; sizes: by lead [d] r, s, w, standard deviations of the prediction, and sgp4, that of the
    published set along the track [m]; better: the set as it is written; burns: when its sets show that it
    burned in the last BURNED days, UTC; thrusts: how many of these sets show that it thrusts; inside: the
    orbit inside the sets, or why SGP4 propagates the improved set; hindsight: of `improve.Improved`.
    """

    improved: Satrec
    published: Satrec
    how: pd.Series
    sizes: pd.DataFrame
    better: rewriting.Better
    burns: Sequence[str]
    thrusts: int
    inside: OrbitInside | str
    hindsight: str

    def _propagated(self, t: np.ndarray) -> np.ndarray:
        if isinstance(self.inside, OrbitInside):
            return self.inside.path(t)
        states = mean_elements.states(self.improved, epoch=self.date, t=t)
        if not np.isfinite(states).all():
            end = t[~np.isfinite(states).all(axis=1)].min()
            most = f"at most --days {np.floor(100.0 * end / DAY) / 100.0:g}" if end > HOUR else "a newer set"
            raise InputError(
                f"predict: {self.identity} decays by SGP4 before {self._texts(end[None])[0]}: give {most}"
            )
        return states

    def sigmas(self, t: np.ndarray) -> np.ndarray:
        """Return standard deviations (n, 3) in RSW [m] at times (n,) [s since the date]."""
        return np.stack([np.interp(t / DAY, self.sizes.index, self.sizes[axis]) for axis in "rsw"], axis=1)

    def covariances(self, t: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Return covariances (n, 6, 6) in RSW [m, m/s] at times (n,) [s since the date]."""
        return sgp4_errors.covariances(self.sigmas(t), states)

    def density(self, t: np.ndarray, states: np.ndarray) -> DensityErrors | None:
        """Return the part of the covariances at times (n,) that other objects share, None where unknown."""
        if not sgp4_errors.are_known(self.published):
            return None
        days = (t - seconds_since(self.date, [self.published])) / DAY
        return sgp4_errors.density_errors(self.published, t, states, days, self.sigmas(t))

    def expected(self) -> pd.DataFrame:
        """Return the table `expected_errors`: of the prediction in RSW, and of SGP4 along the track [m]."""
        leads = [lead for lead in LEADS if lead <= self.days]
        names = {"s": "along_track", "r": "radial", "w": "cross_track", "sgp4": "sgp4_along_track"}
        rows = self.sizes.loc[leads, [*names]].rename(columns=names)
        rows.insert(0, "utc", self._texts(DAY * np.array(leads, float)))
        return rows.rename_axis("lead").reset_index()

    @property
    def past_in_words(self) -> str:
        """What SGP4 and the improved set missed along the track on past mornings, at the longest lead."""
        judged = self.past.dropna(subset=["sigma"])
        if judged.empty:
            return ""
        rows = judged[judged["lead"] == judged["lead"].max()]
        sgp4, improved = (rows[name].abs().median() / 1e3 for name in ("error", "left"))
        return (
            f"its last {ALONG_MORNINGS} mornings at {rows['lead'].iloc[0]:g} d: SGP4 {sgp4:.1f} km, "
            f"improved set {improved:.1f} km (n = {len(rows)})"
        )

    @property
    def remark(self) -> str:
        """What a message says of it."""
        by_sgp4 = "" if isinstance(self.inside, OrbitInside) else ", propagated by SGP4"
        return "; ".join([f"{self.way}{by_sgp4}", *self._cautions()])

    @property
    def way(self) -> str:
        """What was used, in words."""
        of = f" from {self.how['population']}" if self.how["population"] else ""
        if isinstance(self.inside, OrbitInside):
            along = f", along the track corrected as learned{of}" if self.inside.is_corrected else ""
            return f"orbit inside its sets, propagated under full forces{along}"
        names = {
            weighting.LEARNED: f"set improved by forecast density and a correction learned{of}",
            weighting.DENSITY: "set improved by forecast density",
            weighting.UNCHANGED: "set as published",
        }
        return names[self.how["applied"]]

    @property
    def reason(self) -> str:
        """Why that was used, in words."""
        weight = f"weight {self.how['weight']:.0%}, from the errors of its last {weighting.PAST} mornings"
        inside = self.inside.reason if isinstance(self.inside, OrbitInside) else self.inside
        return "; ".join([inside, str(self.how["why"]) or weight, *self._cautions()])

    def _cautions(self) -> Iterator[str]:
        """Yield what the date hides, what sigmas rest on where no past does, and why they are wide."""
        if self.hindsight:
            yield self.hindsight
        if self.basis.endswith(_FEW_JUDGED):
            yield self.basis
        if self.burns:
            count, last = len(self.burns), self.burns[-1]
            yield f"wide: its sets show burns, the last of {count} in {BURNED:g} days on {last[:_DAY]}"
        if self.thrusts:
            yield f"wide: {self.thrusts} of its sets of {BURNED:g} days have a B* below 0, as it thrusts"
        if self.how["jump"] > corrector.JUMP:
            yield f"wide: the newest set misses those before it {self.how['jump']:.0f} times as far as usual"


def predict(
    sets: FilePath | Sequence[FilePath],
    *,
    days: float = 7.0,
    object: str | int | None = None,
    date: str | None = None,
    weather: FilePath = "OBSERVED",
    catalogue: Iterable[FilePath] = (),
    trained: FilePath | None = None,
    progress: Progress = lambda line: None,
) -> Prediction:
    """Predict an object from its public element sets.

    sets: a file or folder, or several, of TLEs or OMMs
    days: how long, 7 at most, as far as errors are known
    object: name, designator or number, where the files have several objects
    date: UTC text; None: when the newest set was known
    weather: OBSERVED, the packaged weather, or a CSSI file
    catalogue: files and folders of other objects' sets, with which the corrector compares
    trained: a model of `opml train`; None: that of the package

    Raises InputError for unreadable files, an object that is not there, or decays before the end, days out of
    range and weather that ends too early.
    """
    if not 0.0 < days <= LEADS[-1]:
        raise InputError(f"predict: expected more than 0 and at most {LEADS[-1]} days, got {days:g}")
    paths = [sets] if isinstance(sets, (str, os.PathLike)) else list(sets)
    history = known_sets.of_object(paths, None if object is None else str(object))
    newest = history[-1]
    latency = 0.0 if date is None else catalogues.LATENCY
    date = _known(newest) if date is None else date
    known = improve.read([*paths, *catalogue], date=date, weather=str(weather), latency=latency)
    public = known_sets.since(date, history, latency=latency, until=0.0)
    burns = burns_before(public, date)
    better = improve.improve(known, trained_model.read(trained), progress=progress)
    (place,) = np.flatnonzero(better.table["number"] == newest.number)
    how = better.table.iloc[place]
    past = _past_of(newest.number, better)
    rows = np.flatnonzero(known.catalogue.table["number"] == newest.number)
    own = known.catalogue.take(rows)
    errors = errors_of_sets(own, date)
    if past.empty:
        past = errors[["morning", "lead"]].assign(error=errors["s"], left=errors["s"], sigma=np.nan)
    identity = known_sets.identity(newest)
    published = own.satellites[-1]
    usual = _usual(published, how["age"])
    is_alone = len(errors) < FEWEST and not _is_corrected(how)
    measured = _usual_where_learned(published, usual) if is_alone else _measured(errors, usual)
    thrusts = thrusting(public) if how["height"] < LOW else 0
    sizes = _sizes(how, past, measured, _after_storm(known.weather.kp, how["height"]))
    sizes = across_burns(sizes, past) if burns or thrusts else sizes
    inside = orbit_prediction.predict(public, newest.number, better, days=days, weather=str(weather))
    if isinstance(inside, OrbitInside):
        sizes = inside.sizes(sizes, _after_storm(known.weather.kp, how["height"]))
    made = Prediction(
        identity,
        date,
        days,
        past,
        _unproven(measured) if is_alone and not isinstance(inside, OrbitInside) else _basis(past),
        changed(published, how["motion"], how["bstar"]),
        published,
        how,
        sizes,
        better.sets[place],
        burns,
        thrusts,
        inside,
        better.hindsight,
    )
    made.states(made.t)  # no errors are told of what decays before
    return made


def _past_of(number: int, better: Improved) -> pd.DataFrame:
    """Return the judged predictions of an object's last ALONG_MORNINGS."""
    first = modified_julian_day(better.date) - ALONG_MORNINGS
    past = better.past
    return past[(past["number"] == number) & (past["morning"] >= first)].reset_index(drop=True)


def _basis(past: pd.DataFrame) -> str:
    """Return what the sizes of errors rest on, in words."""
    return (
        f"by {len(past)} predictions of the object's own {past['morning'].nunique()} mornings, compared with "
        f"later sets; radial and cross-track by {MORNINGS} mornings at most. The usual errors of objects of "
        "that height count as eight more predictions, and errors that all sets share are added"
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
    found = pd.DataFrame(rows, columns=["morning", "lead", *"rsw"]).dropna()
    return found.astype({"lead": int, **dict.fromkeys("rsw", float)})


def _apart(satellite: Satrec, judge: Satrec) -> tuple[float, float, float]:
    """Return how far SGP4 propagates from another set at the epoch of that: outwards, ahead, across [m]."""
    _, *own = judge.sgp4_tsince(0.0)
    since, until = (one.jdsatepoch - epochs.MJD_ZERO + one.jdsatepochF for one in (satellite, judge))
    leap = float(epochs.leap_seconds(since, until)) / DAY
    _, position, _ = satellite.sgp4(judge.jdsatepoch, judge.jdsatepochF + leap)
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


def burns_before(public: Sequence[KnownSet], date: str) -> list[str]:
    """Return when sets of one object, known on a date, show burns of the BURNED days before, UTC."""
    found = [one.t for one in burns_among(public, epoch=date) if one.t >= -DAY * BURNED]
    return ccsds.utc_texts(date, np.array(found))


def thrusting(public: Sequence[KnownSet]) -> int:
    """Return how many sets of the last BURNED days have a B* below 0, as no drag makes it."""
    return sum(one.t >= -DAY * BURNED and one.satellite.bstar < 0.0 for one in public)


def across_burns(sizes: pd.DataFrame, past: pd.DataFrame) -> pd.DataFrame:
    """Return sizes that are along the track at least those of what the past missed, burns and all."""
    missed = past["left"].abs().groupby(past["lead"]).quantile(corrector.LEVEL) / corrector.NORMAL
    least = missed.reindex(sizes.index, fill_value=0.0).cummax()
    return sizes.assign(**{name: np.maximum(sizes[name], least) for name in ("s", "sgp4")})


def _usual(published: Satrec, age: float) -> pd.DataFrame:
    """Return the sizes that errors of such sets usually have, by lead and axis [m]."""
    sizes = sgp4_errors.usual_sigmas(published, age + np.array(LEADS, float))
    return pd.DataFrame(sizes, columns=list(sgp4_errors.AXES), index=list(LEADS))


def _usual_where_learned(published: Satrec, usual: pd.DataFrame) -> pd.DataFrame:
    """Return usual sizes of errors, NaN for orbits that none were learned from."""
    return usual if sgp4_errors.are_known(published) else usual * np.nan


def _unproven(usual: pd.DataFrame) -> str:
    """Return what sizes rest on that neither a corrector nor a past tells, in words."""
    if usual.isna().any(axis=None):
        return f"no covariance: errors of such orbits were not learned, and its past is short: {_FEW_JUDGED}"
    return f"usual errors of sets at its height, kind and age: its past is short: {_FEW_JUDGED}"


def _is_corrected(how: pd.Series) -> bool:
    return bool(np.isfinite(how[f"sigma_{LEADS[-1]}d"]))


def _sizes(how: pd.Series, past: pd.DataFrame, measured: pd.DataFrame, after_storm: float) -> pd.DataFrame:
    """Return the sizes of errors by lead, as in `Prediction`.

    measured: of `_measured`
    after_storm: of `_after_storm`
    """
    sizes = measured.copy()
    sizes["sgp4"] = sizes["s"]
    if _is_corrected(how):
        factor = _factor(past)
        sigma = factor * np.array([how[f"sigma_{lead}d"] for lead in LEADS[1:]], float)
        correction = np.sqrt([how[f"sgp4_{lead}d"] ** 2 - how[f"sigma_{lead}d"] ** 2 for lead in LEADS[1:]])
        sizes.loc[LEADS[1:], "s"] = sigma
        sizes.loc[LEADS[1:], "sgp4"] = np.hypot(sigma, correction)
        sizes.loc[0, ["s", "sgp4"]] = min(sizes.loc[0, "s"], sizes.loc[1, "s"])
    sizes[["s", "sgp4"]] *= after_storm
    sizes["r"] = np.hypot(sizes["r"], lower(sizes["s"], how["motion"]))
    unseen = dict(zip(sgp4_errors.AXES, sgp4_errors.UNSEEN, strict=True))
    for name in sizes:
        sizes[name] = np.hypot(np.maximum.accumulate(sizes[name]), unseen["s" if name == "sgp4" else name])
    return sizes


def _measured(errors: pd.DataFrame, usual: pd.DataFrame) -> pd.DataFrame:
    """Return root mean squares by lead and axis, the object's own against USUAL_SIZES of the usual size."""
    squares = (errors[list(usual)] ** 2).groupby(errors["lead"])
    total = squares.sum().reindex(usual.index, fill_value=0.0)
    count = squares.size().reindex(usual.index, fill_value=0)
    return np.sqrt((total + USUAL_SIZES * usual**2).div(count + USUAL_SIZES, axis=0))


def _factor(past: pd.DataFrame) -> float:
    """Return by how much the object's own past errs more than its sigmas, against USUAL that err as these."""
    ratios, counts = np.minimum((past["left"] / past["sigma"]) ** 2, _GROSS**2), _counts(past)
    return float(np.sqrt(((counts * ratios).sum() + USUAL) / (counts.sum() + USUAL)))


def _counts(errors: pd.DataFrame) -> pd.Series:
    """Return what each error counts: those of seven days hardly change from one morning to the next."""
    return 1.0 / errors["lead"].clip(lower=1)
