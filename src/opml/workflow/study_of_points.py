"""A first study of an object from files of its positions: epoch and days are chosen by them."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import points_from_files
from opml.interop.orbit_from_files import OrbitFiles

LONGEST = 35  # days of points that count at most, the newest
FEWEST = 8  # least days of points
_AHEAD = 7  # days that predictions reach
_TRAINED = 0.6  # of the days
_EPOCH = "2000-01-01T00:00:00"

_STUDY = """\
# yaml-language-server: $schema=workflow/schemas/config.schema.json
results: results/mine
epoch: "{first}T00:00:00"
duration_days: {duration}
environment: {{solar_activity: OBSERVED, knowledge: forecast}}  # or a newer SW-All.csv
fixes: {{mine: {files}}}
fixing: {{mine: {{every_s: 120, stretch_hours: 6}}}}
rsos: {{mine: {{area_to_mass_m2pkg: 0.01, cd: 2.2, cr: 1.25}}}}  # a guess; Cd is fitted
study:
  rsos: [mine]
  days: {{train: [0, {trained}], test: [{trained}, {days}]}}
day: {{}}  # opml day --configfile mine.yaml
"""


@dataclass(frozen=True)
class StudyOfPoints:
    """A study; first: its first day; days: of points; files: of these, which stay where they are."""

    first: str
    days: int
    files: Sequence[FilePath]

    @classmethod
    def of(cls, paths: Sequence[FilePath]) -> "StudyOfPoints":
        """Choose a study by files of one object's points; raise InputError for too few days."""
        begin, end = points_from_files.reach(OrbitFiles(paths, _EPOCH, np.inf))
        midnight = math.ceil(begin / DAY)
        days = math.floor(end / DAY) - midnight
        if days < FEWEST:
            raise InputError(
                f"{paths[0]}: expected points of {FEWEST} whole days or more, got {max(days, 0)}"
            )
        midnight += max(days - LONGEST, 0)
        return cls(epochs.calendar_day(_EPOCH, DAY * midnight + 60.0), min(days, LONGEST), paths)

    @property
    def text(self) -> str:
        """The study as YAML."""
        return _STUDY.format(
            first=self.first,
            duration=self.days + _AHEAD,
            files=json.dumps([str(Path(path).absolute()) for path in self.files]),
            trained=math.floor(_TRAINED * self.days),
            days=self.days,
        )

    @property
    def told(self) -> str:
        """What was chosen, in words."""
        return f"{self.files[0]}: its last {self.days} days of points, from {self.first} on"
