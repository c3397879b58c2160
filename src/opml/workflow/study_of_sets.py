"""A first study of an object from the file of its element sets: epoch, days and body are chosen by them."""

import json
import math
from dataclasses import dataclass
from datetime import date, timedelta
from pathlib import Path

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.element_sets import catalogue
from opml.interop.element_sets.element_set import elements_epoch

LONGEST = 91  # days of sets that count at most, the newest
FEWEST = 20  # least days of sets
_AHEAD = 7  # days that predictions reach
_TRAINED = 0.66  # of the days
_CD = 2.2
_BALLISTIC = 12.741621  # Cd times area to mass [m2/kg] per B* [earth radii^-1], by SGP4's reference density
_BODIES = (0.0003, 0.5)  # area to mass that a guess stays within [m2/kg]
_DATE = len("2016-09-28")

_STUDY = """\
# yaml-language-server: $schema=workflow/schemas/config.schema.json
results: results/mine
epoch: "{first}T00:00:00"
duration_days: {duration}
environment: {{solar_activity: OBSERVED, knowledge: forecast}}  # or a newer SW-All.csv
elements: {{mine: {file}}}
rsos: {{mine: {{area_to_mass_m2pkg: {area_to_mass:.3g}, cd: 2.2, cr: 1.25}}}}  # by its B*; Cd is fitted
study:
  rsos: [mine]
  days: {{train: [0, {trained}], test: [{trained}, {days}]}}
day: {{}}  # opml day --configfile mine.yaml
"""


@dataclass(frozen=True)
class StudyOfSets:
    """A study; first: its first day; days: of sets; area_to_mass: by B* [m2/kg]; file: of the sets."""

    first: date
    days: int
    area_to_mass: float
    file: Path

    @classmethod
    def of(cls, path: FilePath) -> "StudyOfSets":
        """Choose a study by a file of sets; raise InputError for several objects and for too few days."""
        sets = catalogue.readable(path)
        if len(numbers := sorted({one.number for one in sets})) != 1:
            got = ", ".join(map(str, numbers[:5]))
            raise InputError(f"{path}: expected sets of one object, got {len(numbers)}: {got}")
        epochs_of_sets = [str(elements_epoch(one.satellite)) for one in sets]
        begin, end = (np.datetime64(f(epochs_of_sets), "s") for f in (min, max))
        days = min(LONGEST, int((end - begin) / np.timedelta64(1, "D")))
        if days < FEWEST:
            raise InputError(f"{path}: expected sets of {FEWEST} days or more, got those of {days}")
        first = date.fromisoformat(str(end)[:_DATE]) - timedelta(days=days)
        drag = float(np.median([one.satellite.bstar for one in sets]))
        return cls(first, days, float(np.clip(_BALLISTIC * drag / _CD, *_BODIES)), Path(path))

    @property
    def text(self) -> str:
        """The study as YAML; the file of the sets is beside it."""
        return _STUDY.format(
            first=self.first,
            duration=self.days + _AHEAD,
            file=json.dumps(self.file.name),
            area_to_mass=self.area_to_mass,
            trained=math.floor(_TRAINED * self.days),
            days=self.days,
        )

    @property
    def told(self) -> str:
        """What was chosen, in words."""
        return (
            f"{self.file}: its last {self.days} days of sets, from {self.first} on; area to mass "
            f"{self.area_to_mass:.3g} m2/kg by their B*"
        )
