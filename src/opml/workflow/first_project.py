"""A first project of an object from its element sets or positions, which tell epoch, days and body."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date, timedelta
from pathlib import Path

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import points_from_files
from opml.interop.element_sets import known_sets
from opml.interop.element_sets.element_set import elements_epoch, of_files
from opml.interop.orbit_from_files import OrbitFiles
from opml.workflow.new_project import STUDY_COMMAND

LONGEST_SETS, LONGEST_POINTS = 91, 35  # days that count at most, the newest
_FEWEST_SETS, _FEWEST_POINTS = 20, 8  # least days
_AHEAD = 7  # days that predictions reach
_TRAINED = 0.66  # of the days
_CD = 2.2
_BALLISTIC = 12.741621  # Cd times area to mass [m2/kg] per B* [earth radii^-1], by SGP4's reference density
_BODIES = (0.0003, 0.5)  # area to mass that a guess stays within [m2/kg]
_GUESS = 0.01  # area to mass of whose drag nothing is known [m2/kg]
_DATE = len("2016-09-28")
_EPOCH = "2000-01-01T00:00:00"

_FIXING = "fixing: {mine: {every_s: 120, stretch_hours: 6}}"

_RUN = """\
# yaml-language-server: $schema=workflow/schemas/config.schema.json
results: results/mine
epoch: "{first}T00:00:00"
duration_days: {duration}
environment: {{solar_activity: NEWEST, knowledge: forecast}}  # of `opml fetch`
{measured}
rsos: {{mine: {{area_to_mass_m2pkg: {area_to_mass:.3g}, cd: 2.2, cr: 1.25}}}}  # {source}; Cd is fitted
study: {study}
day: {{}}  # opml day --configfile mine.yaml
"""


@dataclass(frozen=True)
class FirstProject:
    """A project of one object.

    text: its settings, YAML; command: that runs it
    chosen: the choice in words; copied: files that the project has copies of
    """

    text: str
    command: str
    chosen: str
    copied: Sequence[Path] = ()

    @classmethod
    def of_sets(cls, path: FilePath) -> "FirstProject":
        """Return mornings over a file of sets; raise InputError for several objects and for too few days."""
        sets = of_files(known_sets.find_files([path]), known_sets.readable)
        if len(numbers := sorted({element_set.number for element_set in sets})) != 1:
            got = ", ".join(map(str, numbers[:5]))
            raise InputError(f"{path}: expected sets of one object, got {len(numbers)}: {got}")
        epochs_of_sets = [str(elements_epoch(element_set.satellite)) for element_set in sets]
        begin, end = (np.datetime64(f(epochs_of_sets), "s") for f in (min, max))
        days = min(LONGEST_SETS, int((end - begin) / np.timedelta64(1, "D")))
        if days < _FEWEST_SETS:
            expected = f"expected sets of {_FEWEST_SETS} days or more, got those of {days}"
            raise InputError(f"{path}: {expected}: `opml fetch --since DATE` gets older ones")
        last = date.fromisoformat(str(end)[:_DATE])
        first = last - timedelta(days=days)
        drag = float(np.median([element_set.satellite.bstar for element_set in sets]))
        area_to_mass = float(np.clip(_BALLISTIC * drag / _CD, *_BODIES))
        # Files are copied; a folder stays where it is, as what is fetched into it counts tomorrow.
        files, copied = Path(path).name, [Path(path)]
        if Path(path).is_dir():
            files, copied = str(Path(path).resolve() / "*"), []
        text = _RUN.format(
            first=first,
            duration=days + _AHEAD,
            measured=f"elements: {{mine: {json.dumps(files)}}}",
            area_to_mass=area_to_mass,
            source="by its B*",
            study="{}",
        )
        chosen = f"{path}: its last {days} days of sets, from {first} on"
        summary = f"{chosen}; area to mass {area_to_mass:.3g} m2/kg by their B*"
        return cls(text, f"opml day --configfile mine.yaml --date {last}", summary, copied)

    @classmethod
    def of_points(cls, paths: Sequence[FilePath]) -> "FirstProject":
        """Return a study over files of one object's positions; raise InputError for too few days."""
        begin, end = points_from_files.reach(OrbitFiles(paths, _EPOCH, np.inf))
        midnight = math.ceil(begin / DAY)
        whole = math.floor(end / DAY) - midnight
        if whole < _FEWEST_POINTS:
            expected = f"points of {_FEWEST_POINTS} whole days or more"
            raise InputError(f"{paths[0]}: expected {expected}, got {max(whole, 0)}")
        days = min(whole, LONGEST_POINTS)
        first = epochs.calendar_day(_EPOCH, DAY * (midnight + whole - days + 0.5))
        trained = math.floor(_TRAINED * days)
        text = _RUN.format(
            first=first,
            duration=days + _AHEAD,
            measured=f"fixes: {{mine: {json.dumps(_pattern(paths))}}}\n{_FIXING}",
            area_to_mass=_GUESS,
            source="a guess",
            study=f"\n  rsos: [mine]\n  days: {{train: [0, {trained}], test: [{trained}, {days}]}}",
        )
        return cls(text, STUDY_COMMAND, f"{paths[0]}: its last {days} days of points, from {first} on")


def _pattern(paths: Sequence[FilePath]) -> list[str]:
    """Return the pattern that these files alone have in their folder, or all their paths."""
    files = sorted(Path(path).absolute() for path in paths)
    pattern = files[0].parent / f"*{files[0].suffix}"
    return [str(pattern)] if sorted(pattern.parent.glob(pattern.name)) == files else [*map(str, files)]
