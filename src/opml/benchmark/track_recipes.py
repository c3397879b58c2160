"""Recipes of tracks: radars see a precise orbit, with noise drawn by name; known is what they measured by t.

The mornings of an object follow each other within its history, as an operator has them: the inputs of one
hold tracks of the days that an earlier one asks about.
"""

from collections.abc import Iterable
from fnmatch import fnmatch
from pathlib import Path

import astropy_iers_data
import numpy as np
import pandas as pd

from opml import __version__
from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath, project_file
from opml.base.section import Section
from opml.base.setting_types import Count, NotNegative, Positive, Text
from opml.benchmark import task_folders, tasks
from opml.benchmark.task_folders import Folders, Question, TaskRecipe, utc_text
from opml.catalog.simulate import tracking
from opml.element_sets.set_errors import LEADS
from opml.environment import earth_orientation, nodes
from opml.interop import tdm, truth_from_orbit
from opml.interop.orbit_from_files import OrbitFiles
from opml.orbits.sheets import read_stations
from opml.tables import STATE

_SHEET = "config/stations.tsv"
_STEP = 20.0  # between measurements [s], as in the paper
_ARCSECOND = np.pi / 648000.0
_DIGITS = {"azimuth": 5, "elevation": 5, "range": 1}  # of degrees and metres: the same text on all machines


class ObservedObject(Section):
    """An object of a recipe, its key the number by which answers name it."""

    files: Text  # pattern of the names of its orbit's files
    first: Text  # UTC text of its first morning, which others follow, one every so many days
    mornings: Count
    every_days: Count
    stations: list[str]  # names in the package's sheet
    area_to_mass: Positive  # [m2/kg]; cr: reflectivity
    cr: NotNegative

    @property
    def times(self) -> list[str]:
        """UTC texts of the mornings."""
        return [utc_text(epochs.mjd(self.first) + self.every_days * k) for k in range(self.mornings)]


class TrackRecipe(TaskRecipe):
    """A recipe of a task of tracks; seed: of the noise."""

    seed: int
    objects: dict[int, ObservedObject]


def make(recipe: TrackRecipe, orbits: Iterable[FilePath], folders: Folders, weather: str | Path) -> int:
    """Make a task as `opml.benchmark.recipes.make` does; orbits: files in SP3, CPF or OEM."""
    files = [Path(path) for path in orbits]
    questions: list[Question] = []
    states: list[np.ndarray] = []
    tracks: dict[str, dict[int, pd.DataFrame]] = {}
    for number, observed in recipe.objects.items():
        epoch = utc_text(epochs.mjd(observed.first) - recipe.history_days)
        orbit, seen = _measured(recipe, number, epoch, files)
        for t in observed.times:
            now = DAY * (epochs.mjd(t) - epochs.mjd(epoch))
            times = now + DAY * np.array(LEADS)
            rows = orbit.set_index(orbit["t"].round()).reindex(times)[STATE].dropna()
            questions += [
                (number, t, lead, utc_text(epochs.mjd(t) + lead))
                for lead, time in zip(LEADS, times, strict=True)
                if time in rows.index
            ]
            states += list(rows.to_numpy())
            part = seen[(seen["t"] <= now) & (seen["t"] >= now - DAY * recipe.history_days)]
            tracks.setdefault(t, {})[number] = part

    def fill(t: str, place: Path) -> None:
        for number, part in tracks[t].items():
            first = recipe.objects[number].first
            epoch = utc_text(epochs.mjd(first) - recipe.history_days)
            tdm.write(path := place / f"{number}.tdm", part, epoch=epoch, rso=str(number))
            path.write_text(path.read_text().replace(f"OPML {__version__}", "OPML"))  # one digest for all
        bodies = [
            (number, recipe.objects[number].area_to_mass, recipe.objects[number].cr) for number in tracks[t]
        ]
        tasks.write_csv(place / "bodies.csv", ("object", "area_to_mass_m2pkg", "cr"), bodies)
        (place / "stations.tsv").write_bytes(project_file(_SHEET).read_bytes())
        _write_orientation(place / "earth_orientation.csv", t, recipe.history_days)

    order = sorted(range(len(questions)), key=lambda k: (questions[k][1], questions[k][0], questions[k][2]))
    truth = pd.DataFrame([states[k] for k in order], columns=[*tasks.STATE])
    return task_folders.freeze(recipe, [questions[k] for k in order], truth, fill, weather, folders)


def _measured(
    recipe: TrackRecipe, number: int, epoch: str, files: list[Path]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return true states of an object since an epoch, UTC text, and what its stations measured."""
    satellite = recipe.objects[number]
    paths = sorted(path for path in files if fnmatch(path.name, satellite.files))
    if not paths:
        raise InputError(f"{recipe.name}: {number}: expected files as {satellite.files}, got none")
    days = recipe.history_days + satellite.every_days * (satellite.mornings - 1) + LEADS[-1]
    orbit, _ = truth_from_orbit.truth(OrbitFiles(paths, epoch, DAY * days), step=_STEP)
    sheet = read_stations(project_file(_SHEET))
    orientation = earth_orientation.tabulate(epoch, nodes(epoch, DAY * days))
    stations = [sheet[name] for name in satellite.stations]
    seen = tracking.simulate(orbit, orientation, stations, rso=str(number), seed=recipe.seed, epoch=epoch)
    for name in ("azimuth", "elevation"):
        seen[name] = np.radians(np.degrees(seen[name]).round(_DIGITS[name]))
    return orbit, seen.assign(range=seen["range"].round(_DIGITS["range"]))


def _write_orientation(path: Path, t: str, days: int) -> None:
    """Write the Earth's orientation measured up to t, to a few centimetres on the ground."""
    table = earth_orientation.read_finals2000a(astropy_iers_data.IERS_A_FILE)
    now = epochs.mjd(t)
    known = table[(table["mjd"] <= now) & (table["mjd"] >= now - days - 1)]
    poles = (known[["x_pole", "y_pole"]] / _ARCSECOND).round(3)
    cells = zip(
        known["mjd"].astype(int), poles["x_pole"], poles["y_pole"], known["ut1_utc"].round(4), strict=True
    )
    tasks.write_csv(path, ("mjd", "x_pole_arcsec", "y_pole_arcsec", "ut1_utc_s"), [*cells])
