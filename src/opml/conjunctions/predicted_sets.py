"""Objects of public sets where `opml predict` has them, as surely as it says."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions.trajectories import PropagatedElements, of_states
from opml.element_sets.improve import FEWEST_SETS
from opml.element_sets.prediction import Prediction, PublicMorning
from opml.interop import ccsds
from opml.interop.element_sets import known_sets
from opml.interop.element_sets.element_set import ElementSet
from opml.interop.ephemeris import EPOCH, Ephemeris
from opml.interop.predicted_orbit import LEADS

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class PredictedSets:
    """The sets in files, predicted from a time on.

    paths: of the files; begin: when predictions begin, a whole second [s since EPOCH]; end: of the
    span that is asked for; weather: OBSERVED, the packaged one, or a CSSI file
    """

    paths: Sequence[FilePath]
    begin: float
    end: float
    weather: FilePath

    def trajectories(self, elements: PropagatedElements) -> Sequence[Ephemeris]:
        """Return where an object is predicted; by SGP4 with few sets, and where no prediction can be made."""
        history = self._histories[elements.identity.number]
        if len(history) < FEWEST_SETS or self._days > LEADS[-1] or self._morning is None:
            return elements.trajectories()
        try:
            return [self._trajectory(self._morning.predict(history, days=self._days))]
        except InputError as reason:
            _log.warning("%s: propagated by SGP4: %s", elements.identity, reason)
            return elements.trajectories()

    def _trajectory(self, prediction: Prediction) -> Ephemeris:
        """Return a prediction, times since EPOCH."""
        since = epochs.seconds_between(EPOCH, prediction.date)
        trajectory = of_states(prediction.ephemeris().shifted(since))
        return replace(trajectory, remark=f"as opml predict states it: {prediction.way}")

    @property
    def _days(self) -> float:
        return (self.end - self.begin) / DAY

    @cached_property
    def _histories(self) -> dict[int, list[ElementSet]]:
        return known_sets.by_object(self.paths)

    @cached_property
    def _morning(self) -> PublicMorning | None:
        """What was public when predictions begin; None where the log says what is missing."""
        (date,) = ccsds.utc_texts(EPOCH, np.array([self.begin]))
        try:
            morning = PublicMorning.read(
                self.paths, date=date.partition(".")[0], weather=self.weather, latency=0.0
            )
        except InputError as reason:
            _log.warning("element sets are propagated by SGP4: %s", reason)
            return None
        if morning.better.hindsight:
            _log.warning(morning.better.hindsight)
        return morning
