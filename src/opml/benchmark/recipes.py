"""Recipes: how a task is made from public element sets, weather and forecasts.

Objects fall into groups by their number. A morning asks for one group, so that an object's next history
begins after what was asked last: no file of a task holds what another question asks for.
"""

import json
from collections.abc import Iterable
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath, replacing_folder
from opml.base.section import Section
from opml.base.seeds import derive
from opml.base.setting_types import Count, NotNegative, Text
from opml.base.yaml_files import read_yaml
from opml.benchmark import tasks
from opml.element_sets import catalogue as catalogues
from opml.element_sets import pairs
from opml.element_sets.catalogue import ElementCatalogue, modified_julian_day
from opml.element_sets.improve import OLDEST_WEATHER, check_newest
from opml.element_sets.training import HOUR_OF_MORNING
from opml.environment import knowledge
from opml.environment.space_weather import INTERVALS, KP
from opml.environment.weather import MEAN_DAYS, Weather
from opml.interop import ccsds
from opml.interop.element_sets import mean_elements, tle
from opml.interop.element_sets.element_set import seconds_since

_WEATHER_DAYS = 200
_TLE = 2  # lines
_ISSUED = "issued"


class Recipe(Section):
    """How a task is made.

    first, last: dates of the mornings that ask, one every so many days
    groups: of objects, each asked in turn
    history_days: days of sets before a morning
    latency_hours: from epoch to publication of sets that do not tell when they were made
    digest: SHA-256 of SHA256SUMS, '' before the task is frozen
    """

    name: Text
    title: Text
    first: date
    last: date
    every_days: Count
    groups: Count
    history_days: Count
    latency_hours: NotNegative = 6.0
    digest: str = ""

    @property
    def mornings(self) -> np.ndarray:
        """Times (n,) that ask, modified Julian days, 06 UTC."""
        first, last = (modified_julian_day(f"{one}T00:00:00") for one in (self.first, self.last))
        return np.arange(first, last + 1.0, self.every_days) + HOUR_OF_MORNING


def read(path: FilePath) -> Recipe:
    """Read a recipe. Raises InputError for another format, a key that is none, and overlapping histories."""
    values: Any = read_yaml(path)
    if not isinstance(values, dict) or values.pop("format", None) != tasks.FORMAT:
        raise InputError(f"{path}: format: expected {tasks.FORMAT}")
    recipe = Recipe.read(values, str(path))
    if recipe.groups * recipe.every_days < recipe.history_days + pairs.LEADS[-1] + 1:
        raise InputError(f"{path}: groups: expected more, so that no history holds what was asked before")
    return recipe


def make(
    recipe: Recipe,
    sets: Iterable[FilePath],
    folder: FilePath,
    truth_folder: FilePath,
    *,
    weather: str | Path,
    forecasts: FilePath | None = None,
) -> int:
    """Make the folders of a task and of its truth; return the number of questions.

    sets: files and folders of TLEs
    weather: OBSERVED or a CSSI file
    forecasts: CSV of forecasts with a column `issued` (UTC), as they were issued; None: the task has none

    Raises InputError for unreadable files, without a question, for folders that hold anything but a task or a
    truth, for weather that ends before a morning, and where the task is not the frozen one.
    """
    _check_free(Path(folder), tasks.TASK)
    _check_free(Path(truth_folder), tasks.TRUTH)
    catalogue = catalogues.read(sets, latency=recipe.latency_hours / 24.0)
    rows, judges = _asked(recipe, catalogue)
    questions, states = _questions(catalogue, rows, judges)
    issued = None if forecasts is None else _read_forecasts(forecasts)
    measured = knowledge.read(weather)
    with replacing_folder(folder) as new, replacing_folder(truth_folder) as new_truth:
        header = (*tasks.QUESTION, *tasks.STATE)
        told = [(*one, *_rounded(state)) for one, state in zip(questions, states, strict=True)]
        tasks.write_csv(new_truth / tasks.TRUTH, header, told)
        tasks.write_csv(new / tasks.QUESTIONS, tasks.QUESTION, questions)
        for morning, part in rows.groupby("morning", sort=True):
            place = new / tasks.INPUTS / tasks.folder_name(_text(float(morning)))
            place.mkdir(parents=True)
            _write_sets(place / "sets.tle", recipe, catalogue, part, float(morning))
            known = measured.keep_known(float(morning))
            check_newest(known, weather, date=_text(float(morning)), oldest=OLDEST_WEATHER)
            _write_weather(place / "weather.csv", known)
            if issued is not None:
                _write_forecast(place / "forecast.csv", issued, _text(float(morning)))
        _write_task(new, recipe, tasks.digest(new_truth / tasks.TRUTH))
        found = tasks.digest(new / tasks.SUMS)
        if recipe.digest not in ("", found):
            raise InputError(f"{recipe.name}: digest: expected {recipe.digest}, got {found}: other sources")
    return len(questions)


def _check_free(folder: Path, name: str) -> None:
    """Raise InputError for a file, and for a folder that is not empty and has no file of a name."""
    if folder.is_dir() and ((folder / name).is_file() or not any(folder.iterdir())):
        return
    if folder.exists():
        raise InputError(f"{folder}: expected a new folder, an empty one or one with {name}, got another")


def _rounded(state: np.ndarray) -> list[str]:
    """Return a state to a tenth of a millimetre, so that its digest is the same on all machines."""
    return [f"{value:.4f}" for value in state[:3]] + [f"{value:.7f}" for value in state[3:]]


def _write_task(folder: Path, recipe: Recipe, truth_digest: str) -> None:
    facts = {
        "format": tasks.FORMAT,
        "name": recipe.name,
        "title": recipe.title,
        "latency_hours": recipe.latency_hours,
        "truth_sha256": truth_digest,
    }
    (folder / tasks.TASK).write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    sums = "\n".join(tasks.sums_of(folder)) + "\n"
    (folder / tasks.SUMS).write_text(sums, encoding="utf-8")


def _asked(recipe: Recipe, catalogue: ElementCatalogue) -> tuple[pd.DataFrame, np.ndarray]:
    """Return the rows of pairs that are asked, and the sets (rows,) that judge them."""
    mornings = recipe.mornings
    rows, judges = pairs.find(catalogue, mornings)
    turn = np.searchsorted(mornings, rows["morning"].to_numpy()) % recipe.groups
    asked = (judges >= 0) & (turn == _group(rows["number"].to_numpy(), recipe.groups))
    if not asked.any():
        raise InputError(f"{recipe.name}: expected sets from {recipe.first} on with later ones, got none")
    order = rows[asked].sort_values(["morning", "number", "lead"], kind="stable").index
    return rows.loc[order].reset_index(drop=True), judges[order]


def _group(numbers: np.ndarray, groups: int) -> np.ndarray:
    """Return the group of each catalogue number (n,), by the number alone."""
    objects, place = np.unique(numbers, return_inverse=True)
    drawn = [int(derive(0, "group of a benchmark", str(one)).integers(groups)) for one in objects]
    return np.array(drawn, dtype=int)[place]


def _text(morning: float) -> str:
    """Return a morning as UTC text."""
    minutes = round(morning % 1.0 * 1440.0)
    return f"{epochs.calendar(morning)}T{minutes // 60:02d}:{minutes % 60:02d}:00"


def _questions(
    catalogue: ElementCatalogue, rows: pd.DataFrame, judges: np.ndarray
) -> tuple[list[tuple[int, str, int, str]], list[np.ndarray]]:
    """Return the questions and true GCRF states: of the sets that judge, at their own epochs."""
    questions, states = [], []
    for (number, morning, lead), judge in zip(
        rows[["number", "morning", "lead"]].itertuples(index=False), judges, strict=True
    ):
        satellite = catalogue.satellites[judge]
        (time,) = ccsds.utc_texts(tasks.EPOCH, seconds_since(tasks.EPOCH, [satellite]))
        questions.append((int(number), _text(float(morning)), int(lead), time))
        states.append(mean_elements.state(satellite, epoch=time))
    return questions, states


def _write_sets(
    path: Path, recipe: Recipe, catalogue: ElementCatalogue, rows: pd.DataFrame, morning: float
) -> None:
    """Write the sets that were known on a morning, of its objects, as their files have them."""
    table = catalogue.table
    known = (table["known"] <= morning) & (table["t"] >= morning - recipe.history_days)
    own = table[known & table["number"].isin(rows["number"].unique())]
    texts = {file: mean_elements.read_text(file) for file in own["file"].unique()}
    pieces = {file: dict(enumerate(tle.pieces(text))) for file, text in texts.items()}
    lines = [
        line
        for file, place in zip(own["file"], own["place"], strict=True)
        for _, line in pieces[file].get(place, [(0, "")])[-_TLE:]
    ]
    if not all(line.startswith(("1 ", "2 ")) for line in lines):
        raise InputError(f"{own['file'].iloc[0]}: expected TLEs of two lines, got another format")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _write_weather(path: Path, known: Weather) -> None:
    """Write the whole days of measured weather, with the mean flux of the days before, in CSSI's format."""
    count = min(len(known.flux), len(known.kp) // INTERVALS)
    first = max(MEAN_DAYS, count - _WEATHER_DAYS)
    lines = [
        "# Kp: GFZ Potsdam, CC BY 4.0; F10.7: DRAO, Penticton. The mean flux is that of the last 81 days.",
        ",".join(["DATE", *KP, "F10.7_OBS", "F10.7_DATA_TYPE", "F10.7_OBS_CENTER81"]),
    ]
    for day in range(first, count):
        kp = (f"{round(10.0 * one)}" for one in known.kp[INTERVALS * day : INTERVALS * (day + 1)])
        mean = known.flux[day - MEAN_DAYS + 1 : day + 1].mean()
        figures = [*kp, f"{known.flux[day]:.1f}", "OBS", f"{mean:.1f}"]
        lines.append(",".join([epochs.calendar(known.first + day), *figures]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _read_forecasts(path: FilePath) -> pd.DataFrame:
    try:
        table = pd.read_csv(path, dtype=str)
    except (OSError, ValueError) as reason:
        raise InputError(f"{path}: expected comma-separated values, got {reason}") from None
    if _ISSUED not in table:
        raise InputError(f"{path}: expected a column {_ISSUED}, got {', '.join(table.columns)}")
    return table


def _write_forecast(path: Path, issued: pd.DataFrame, morning: str) -> None:
    """Write the rows of the newest issue up to a morning, if there is one."""
    known = issued[issued[_ISSUED].str.rstrip("Z") <= morning]
    newest = known[known[_ISSUED] == known[_ISSUED].max()]
    tasks.write_csv(path, [*issued.columns], [*newest.itertuples(index=False, name=None)])
