"""Objects of public sets where `opml predict` has them, as surely as it says."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions.trajectories import ScreenedElements, of_states
from opml.element_sets.improve import FEWEST_SETS
from opml.element_sets.prediction import PublicMorning
from opml.interop import ccsds
from opml.interop.element_sets import known_sets
from opml.interop.ephemeris import EPOCH, Ephemeris
from opml.interop.predicted_orbit import LEADS

_log = logging.getLogger(__name__)


def predictor(
    paths: Sequence[FilePath], *, begin: float, end: float, weather: FilePath
) -> Callable[[ScreenedElements], Sequence[Ephemeris]]:
    """Return what predicts an object of sets in files, by SGP4 with few sets, and where nothing else can.

    begin: when predictions begin, a whole second [s since EPOCH]; end: of the span that is asked for
    weather: OBSERVED, the packaged one, or a CSSI file
    """
    days = (end - begin) / DAY
    histories = cache(lambda: known_sets.by_object(paths))
    morning = cache(lambda: _public_at(begin, paths, weather))

    def trajectories(elements: ScreenedElements) -> Sequence[Ephemeris]:
        history = histories()[elements.identity.number]
        if len(history) < FEWEST_SETS or days > LEADS[-1] or (public := morning()) is None:
            return elements.by_sgp4()
        try:
            prediction = public.predict(history, days=days)
            since = epochs.seconds_between(EPOCH, prediction.date)
            trajectory = of_states(prediction.ephemeris.shifted(since))
        except InputError as reason:
            _log.warning("%s: propagated by SGP4: %s", elements.identity, reason)
            return elements.by_sgp4()
        return [replace(trajectory, remark=f"as opml predict states it: {prediction.way}")]

    return trajectories


def _public_at(begin: float, paths: Sequence[FilePath], weather: FilePath) -> PublicMorning | None:
    """Return what was public at a time [s since EPOCH]; None where the log says what is missing."""
    (date,) = ccsds.utc_texts(EPOCH, np.array([begin]))
    try:
        morning = PublicMorning.read(paths, date=date.partition(".")[0], weather=weather, latency=0.0)
    except InputError as reason:
        _log.warning("element sets are propagated by SGP4: %s", reason)
        return None
    if morning.better.hindsight:
        _log.warning(morning.better.hindsight)
    return morning
