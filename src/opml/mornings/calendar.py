"""The dates of mornings."""

from dataclasses import dataclass
from datetime import date, timedelta

from opml.base import epochs
from opml.base.constants import HOUR

HORIZON = 45  # earlier mornings that count


@dataclass(frozen=True)
class Calendar:
    """The dates of mornings."""

    epoch: str  # of the run, UTC text
    hour: float  # of the mornings, UTC

    def time(self, day: date) -> float:
        """Return when the morning of a date is [s]."""
        return epochs.seconds_between(self.epoch, f"{day.isoformat()}T00:00:00") + HOUR * self.hour

    def first(self, known: float) -> date:
        """Return the first date whose morning is not before a time [s]."""
        day = date.fromisoformat(epochs.calendar_day(self.epoch, known))
        return day if self.time(day) >= known else day + timedelta(days=1)
