"""Prediction of an object from its points or tracks, with covariances: its mornings run again.

The mornings up to a date fit what was measured by then, under the forces and the weather that were known, and
judge what they issued. The last one's ephemeris is the prediction.
"""

import logging
from dataclasses import replace

import numpy as np
import pandas as pd

from opml.base.constants import DAY, WGS84_A
from opml.base.errors import InputError
from opml.base.progress import Progress, with_time_left
from opml.ephemerides.along_track_shift import through
from opml.interop.predicted_orbit import PredictedOrbit, sampled
from opml.learning.models.learners import arc_of
from opml.mornings import issued
from opml.mornings.morning import TrackMorning, morning
from opml.mornings.prediction_request import AFTER, GUESS, OrbitSettings, Request, Times, watch
from opml.mornings.records import Records
from opml.mornings.verdicts import OLDEST
from opml.orbits.rsw_covariance import ErrorModel
from opml.tables import STATE, STATE_COVARIANCES, state_rows, symmetric_matrices

_TRIED = (0.0005, 0.005, 0.01)  # areas to mass of fits that show how light presses [m2/kg]
_PRIOR = 1e-3  # what an area to mass twice GUESS counts as, in mean squares of weighted residuals
_BODIES = (1e-4, 0.1)  # areas to mass of satellites [m2/kg]
LIT = 1000e3  # height above which light presses more than drag does [m]
_NO_ORBIT = 50.0  # root mean square of the weighted residuals of what no orbit fits: 78 with z mirrored
_ROUGH_FIT = 10.0  # the same of what forces hardly explain: 30 with a sign wrong, 20 across a burn


_log = logging.getLogger(__name__)


def predict(request: Request, settings: OrbitSettings, *, progress: Progress) -> PredictedOrbit:
    """Predict an object from what measured it.

    Raises InputError for unreadable files, a date without measurements before it, weather that ends too
    early, and measurements that no orbit fits.
    """
    times = Times.of(request)
    progress(f"weather and forces from {times.epoch.partition('T')[0]} on")
    watched = watch(request, settings, times)
    # What is too old to be propagated from the date on is propagated no farther than it can be judged.
    judged_alone = replace(watched, plan=replace(watched.plan, end=times.date + AFTER))
    records, newest = Records.empty(), None
    for now in with_time_left(times.mornings.tolist(), "morning", progress):
        left = morning(judged_alone if now < times.date - OLDEST else watched, records, now=now)
        records = records.and_then(left.records, since=now - DAY * watched.plan.max_days)
        newest = newest if left.ephemeris is None else left
    if not records.paths:
        asked = "are frame, axes and units right, points more than a few, the body's area to mass possible?"
        why = left.verdict.reason if request.kind == "tracks" else asked
        raise InputError(f"{request.files[0]}: expected what an orbit fits, got none: {why}")
    estimates = records.estimates[records.estimates["track"] == records.paths[-1].start]
    if (rms := estimates["weighted_rms"].max()) > _NO_ORBIT:
        asked = "are object, frame and times right, or did it burn in the last days before --date?"
        got = f"got some {rms:.0f} standard deviations off the best: {asked}"
        raise InputError(f"{request.files[0]}: expected measurements of an orbit, {got}")
    if rms > _ROUGH_FIT:
        asked = "are sigmas, frame, axes and times right, or did it burn?"
        _log.warning("%s: measurements are off their fit by %.0f sigma: %s", request.files[0], rms, asked)
    height = float(np.linalg.norm(estimates[STATE[:3]].iloc[0])) - WGS84_A
    if request.area_to_mass is None and height > LIT:
        progress("area to mass, by how light presses")
        area = _area_by_light(request, settings, times)
        if area is not None:
            _log.warning("%s: area to mass of %.2g m2/kg, by how light presses", request.files[0], area)
            return predict(replace(request, area_to_mass=area), settings, progress=progress)
        guess = "area to mass is a guess, %g m2/kg: light presses by it, more than drag: give --area-to-mass"
        _log.warning(f"%s: {guess}", request.files[0], GUESS)
    expected = f"{request.files[0]}: expected an orbit for {request.days:g} days, got"
    if newest is None:
        raise InputError(f"{expected} none: {left.verdict.reason}")
    assert newest.ephemeris is not None
    if (end := float(newest.ephemeris["t"].iloc[-1]) - times.date) < DAY * request.days:
        ends = f"after {end / DAY:.1f}" if end > 0.0 else "as little was measured before the date"
        raise InputError(f"{expected} one that comes down, or is hardly determined, {ends}")
    return _fitted_orbit(request, times, newest)


def _area_by_light(request: Request, settings: OrbitSettings, times: Times) -> float | None:
    """Return the area to mass [m2/kg] whose fit leaves least, near GUESS; None where fits hardly tell it.

    The mean square of what the newest, longest fit leaves is a parabola of the pressure of light.
    """
    squares = []
    for area in _TRIED:
        watched = watch(replace(request, area_to_mass=area), settings, times)
        fitted = morning(watched, Records.empty(), now=times.date).records.estimates
        newest = fitted[(fitted["track"] == fitted["track"].max()) & fitted["converged"].astype(bool)]
        if newest.empty:
            return None
        squares.append(float(newest.sort_values("window_hours")["weighted_rms"].iloc[-1]) ** 2)
    curve = np.polynomial.Polynomial.fit(_TRIED, squares, 2).convert().coef
    prior = _PRIOR / GUESS**2
    if curve[2] < prior:
        return None
    return float(np.clip((prior * GUESS - 0.5 * curve[1]) / (prior + curve[2]), *_BODIES))


def _fitted_orbit(request: Request, times: Times, newest: TrackMorning) -> PredictedOrbit:
    """Return what the newest morning issued that could."""
    assert newest.ephemeris is not None
    assert newest.selected is not None
    watched, selected, verdict = newest.watched, newest.selected, newest.verdict
    table = newest.ephemeris.assign(t=newest.ephemeris["t"] - times.date)
    errors = selected.past.assign(lead=selected.past["duration"] / DAY, left=selected.past["e_y"])
    count = sum(times.mornings[0] <= one.t for one in watched.known_by(times.date))
    burned = f"; burns in its mornings: {count}, across which no error counts" if count else ""
    model = watched.plan.models[selected.model]
    of_mean = ", its drag the mean of such fits" if issued.holds_cd(model) else ""
    hours, _ = arc_of(model) or (0.0, 0.0)
    way = f"fit over {hours:g} h under all forces{of_mean}"

    def covariances(t: np.ndarray, _: np.ndarray) -> np.ndarray:
        columns = {name: np.interp(t, table["t"], table[name]) for name in STATE_COVARIANCES}
        return symmetric_matrices(pd.DataFrame(columns), STATE_COVARIANCES)

    path = through(table["t"].to_numpy(), state_rows(table))
    return PredictedOrbit(
        sampled(watched.identity, request.days, path, ErrorModel(covariances), remark=way),
        times.utc,
        request.days,
        errors[["morning", "lead", "left"]].reset_index(drop=True),
        selected.basis,
        way,
        f"{verdict.word}: {verdict.reason}{burned}",
    )
