"""Recipes: how a task is made from public element sets, or orbits, and the weather.

Objects fall into groups by their number. A morning asks for one group, so that an object's next history
begins after the last question about it: no file of a task holds the answer to a question.
"""

from collections.abc import Iterable, Sequence
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath, replacing_folder
from opml.base.seeds import derive
from opml.base.setting_types import Count, NotNegative
from opml.base.yaml_files import read_yaml
from opml.benchmark import set_truths, task_folders, tasks, track_recipes
from opml.benchmark.set_truths import Judge
from opml.benchmark.task_folders import Folders, Question, TaskRecipe, utc_text
from opml.benchmark.track_recipes import TrackRecipe
from opml.element_sets import catalogue as catalogues, set_errors
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.training import HOUR_OF_MORNING
from opml.environment import known_weather
from opml.environment.solar_activity import OBSERVED
from opml.interop import ccsds
from opml.interop.element_sets import mean_elements, tle
from opml.interop.element_sets.element_set import seconds_since
from opml.interop.orbit_arcs import contents

_TLE = 2  # lines


class Recipe(TaskRecipe):
    """A recipe of element sets; first, last: dates of the mornings that ask, one every so many days."""

    first: date
    last: date
    every_days: Count
    groups: Count  # of objects, each in turn
    latency_hours: NotNegative = 6.0  # from epoch to publication of sets without a creation date

    @property
    def mornings(self) -> np.ndarray:
        """Times (n,) that ask, modified Julian days, 06 UTC."""
        first, last = (epochs.mjd(f"{text}T00:00:00") for text in (self.first, self.last))
        return np.arange(first, last + 1.0, self.every_days) + HOUR_OF_MORNING


def read(path: FilePath) -> Recipe | TrackRecipe:
    """Read a recipe, of tracks where it names objects.

    Raises InputError for another format, a key that is none, and overlapping histories.
    """
    values: Any = read_yaml(path)
    if not isinstance(values, dict) or values.pop("format", None) != tasks.FORMAT:
        raise InputError(f"{path}: format: expected {tasks.FORMAT}")
    if "objects" in values:
        return TrackRecipe.read(values, str(path))
    recipe = Recipe.read(values, str(path))
    if recipe.groups * recipe.every_days < recipe.history_days + set_errors.LEADS[-1] + 1:
        raise InputError(f"{path}: groups: expected more, so that no history holds an earlier answer")
    return recipe


def make(
    recipe: Recipe | TrackRecipe,
    orbits: Sequence[FilePath],
    folders: Folders,
    weather: str | Path = OBSERVED,
    judge: Judge = set_truths.inside,
) -> int:
    """Make the folders of a task and of its truth; return the number of questions.

    orbits: files and folders of TLEs, or of precise orbits; none: those of the recipe's source
    weather: OBSERVED, the packaged weather, or a CSSI file; judge: gives the truth of element sets

    A task whose mornings have no later sets yet is hidden: `make_truth` makes its truth once they are there.
    Raises InputError for unreadable files, without a question, and where the task is not the frozen one.
    """
    folders.check_free()
    paths = orbits or (recipe.source.fetch() if recipe.source else [])
    if not paths:
        raise InputError(f"{recipe.name}: expected files to make it from, as its recipe has no source")
    if isinstance(recipe, TrackRecipe):
        return track_recipes.make(recipe, paths, folders, weather)
    catalogue = catalogues.read(paths, latency=recipe.latency_hours / 24.0)
    rows, judges = _questioned(recipe, catalogue)
    truth = pd.DataFrame()
    if len(judges):
        truth = judge(catalogue.take(judges), weather)
        known = np.isfinite(truth).all(axis=1).to_numpy()
        if not known.any():
            raise InputError(f"{recipe.name}: expected later sets with an orbit inside, got none")
        rows, judges, truth = rows[known], judges[known], truth[known]
    questions = _questions(catalogue, rows, judges)
    mornings = {utc_text(float(morning)): part for morning, part in rows.groupby("morning")}

    def fill(t: str, place: Path) -> None:
        _write_sets(place / "sets.tle", recipe, catalogue, mornings[t])

    return task_folders.freeze(recipe, questions, truth, fill, weather, folders, recipe.latency_hours)


def make_truth(folders: Folders, sets: Iterable[FilePath]) -> int:
    """Make the truth of a hidden task from sets published later; return the number of questions it judges.

    The later set nearest in time, at most half a day away, gives the state by SGP4. Weeks are as
    stormy as the packaged weather has them. Raises InputError for unreadable files, and without such a set.
    """
    task = tasks.read(folders.task)
    if task.truth_digest != tasks.HIDDEN:
        raise InputError(f"{task.name}: expected a hidden task, got one whose truth is frozen")
    if (frozen := Path(folders.truth, tasks.TRUTH)).is_file():
        raise InputError(f"{frozen}: expected no truth yet, got that of SHA-256 {tasks.digest(frozen)}")
    task_folders.check_free(Path(folders.truth), tasks.TRUTH)
    table = (catalogue := catalogues.read(sets, latency=task.latency)).table
    states = np.full((len(task.questions), 6), np.nan)
    for k, (number, t, _, time) in enumerate(task.questions.itertuples(index=False)):
        gaps = (table["t"] - epochs.mjd(time)).abs()
        gaps = gaps[(table["number"] == number) & (table["t"] > epochs.mjd(t))]
        if len(gaps) and gaps.min() <= set_errors.REACH:
            states[k] = mean_elements.state(catalogue.satellites[gaps.idxmin()], epoch=time)
    judged = np.isfinite(states).all(axis=1)
    if not judged.any():
        raise InputError(f"{task.name}: expected sets within half a day of the questions, got none")
    questions = list(task.questions[judged].itertuples(index=False, name=None))
    with replacing_folder(folders.truth) as new:
        truth = pd.DataFrame(states[judged], columns=[*tasks.STATE])
        task_folders.write_truth(new, questions, truth, known_weather.read(OBSERVED))
    return len(questions)


def _questioned(recipe: Recipe, catalogue: ElementCatalogue) -> tuple[pd.DataFrame, np.ndarray]:
    """Return the rows of pairs of the questions, and the sets (rows,) that judge them, none if hidden."""
    mornings = recipe.mornings
    rows, judges = set_errors.find(catalogue, mornings)
    turn = np.searchsorted(mornings, rows["morning"].to_numpy()) % recipe.groups
    chosen = turn == _group(rows["number"].to_numpy(), recipe.groups)
    is_hidden = not (judges >= 0).any()
    if not is_hidden:
        chosen &= judges >= 0
    if not chosen.any():
        raise InputError(f"{recipe.name}: expected sets from {recipe.first} on with later ones, got none")
    order = rows[chosen].sort_values(["morning", "number", "lead"], kind="stable").index
    return rows.loc[order].reset_index(drop=True), judges[order][: 0 if is_hidden else None]


def _group(numbers: np.ndarray, groups: int) -> np.ndarray:
    """Return the group of each catalogue number (n,), by the number alone."""
    objects, place = np.unique(numbers, return_inverse=True)
    drawn = [int(derive(0, "group of a benchmark", str(number)).integers(groups)) for number in objects]
    return np.array(drawn, dtype=int)[place]


def _questions(catalogue: ElementCatalogue, rows: pd.DataFrame, judges: np.ndarray) -> list[Question]:
    """Return the questions, about the epochs of the sets that judge; if hidden, about whole days after t."""
    times = [utc_text(float(at)) for at in rows["morning"] + rows["lead"]]
    if len(judges):
        epochs = seconds_since(tasks.EPOCH, [catalogue.satellites[judge] for judge in judges])
        times = ccsds.utc_texts(tasks.EPOCH, epochs)
    columns = rows[["number", "morning", "lead"]].itertuples(index=False)
    return [
        (int(number), utc_text(float(morning)), int(lead), time)
        for (number, morning, lead), time in zip(columns, times, strict=True)
    ]


def _write_sets(path: Path, recipe: Recipe, catalogue: ElementCatalogue, rows: pd.DataFrame) -> None:
    """Write the sets that were known on the morning of rows, of its objects, as their files have them."""
    table, morning = catalogue.table, float(rows["morning"].iloc[0])
    known = (table["known"] <= morning) & (table["t"] >= morning - recipe.history_days)
    own = table[known & table["number"].isin(rows["number"].unique())]
    own = own.drop_duplicates(["number", "t"], keep="last")
    texts = {file: contents(file).decode() for file in own["file"].unique()}
    pieces = {file: dict(enumerate(tle.pieces(file, text))) for file, text in texts.items()}
    lines = [
        line
        for file, place in zip(own["file"], own["place"], strict=True)
        for _, line in pieces[file].get(place, [(0, "")])[-_TLE:]
    ]
    if not all(line.startswith(("1 ", "2 ")) for line in lines):
        raise InputError(f"{own['file'].iloc[0]}: expected TLEs of two lines, got another format")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
