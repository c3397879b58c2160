"""The folders of a task and of its truth: the part common to all kinds of recipes, digests last."""

import hashlib
import json
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath, replacing_folder
from opml.base.section import Section
from opml.base.setting_types import Count, Text
from opml.benchmark import tasks
from opml.environment import known_weather
from opml.environment.nrlmsis import ap_of_kp
from opml.environment.space_weather import INTERVALS, KP
from opml.environment.weather import MEAN_DAYS, Weather
from opml.fetch.pinned_files import PinnedFiles

_WEATHER_DAYS = 200
_WEEK = 7  # days after t whose storms count


@dataclass(frozen=True)
class Folders:
    """Folders of a task and of its truth."""

    task: FilePath
    truth: FilePath

    @classmethod
    def of(cls, task: str) -> Self:
        """Return a task's folder and that of its truth next to it."""
        return cls(task, f"{task.rstrip('/')}-truth")

    @property
    def truth_in_words(self) -> str:
        """Return where the truth is, or how it is made."""
        is_known = Path(self.truth).exists()
        return (
            f"{self.truth} is {'for the judge alone' if is_known else 'made by `opml truth` when it is over'}"
        )

    def check_free(self) -> None:
        """Raise InputError where they hold anything but a task and a truth."""
        check_free(Path(self.task), tasks.TASK)
        check_free(Path(self.truth), tasks.TRUTH)


Question = tuple[int, str, int, str]  # object, t, lead [d] and time, the times as UTC texts


class TaskRecipe(Section):
    """A recipe of a task: what all kinds have.

    digest: of questions and inputs, '' before the task is frozen; source: files that it is made from, None:
    the user's own
    """

    name: Text
    title: Text
    history_days: Count  # days of inputs before a morning
    digest: str = ""
    source: PinnedFiles | None = None


def freeze(
    recipe: TaskRecipe,
    questions: Sequence[Question],
    truth: pd.DataFrame,
    fill: Callable[[str, Path], None],
    weather: str | Path,
    folders: Folders,
    latency_hours: float = 0.0,
) -> int:
    """Write the folders of a task and of its truth; return the number of questions.

    truth: columns of tasks.TRUE of the questions; no rows: it is made later
    fill: writes the orbits that were known at t into the folder of its inputs
    weather: OBSERVED, the packaged weather, or a CSSI file
    latency_hours: from epoch to publication of sets without a creation date

    Raises InputError for unreadable weather, one that ends before a morning, and a task that is not the
    frozen one.
    """
    measured = known_weather.read(weather)
    with ExitStack() as stack:
        new = stack.enter_context(replacing_folder(folders.task))
        tasks.write_csv(new / tasks.QUESTIONS, tasks.QUESTION, questions)
        times = sorted({t for _, t, _, _ in questions})
        for t in times:
            place = new / tasks.INPUTS / tasks.folder_name(t)
            place.mkdir(parents=True)
            fill(t, place)
            _write_weather(place / "weather.csv", known_weather.known_on(t, measured, weather))
        digest = tasks.HIDDEN
        if len(truth):
            place = stack.enter_context(replacing_folder(folders.truth))
            digest = write_truth(place, questions, truth, measured)
        facts = {
            "format": tasks.FORMAT,
            "name": recipe.name,
            "title": recipe.title,
            "latency_hours": latency_hours,
            "truth_sha256": digest,
        }
        (new / tasks.TASK).write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
        sums = tasks.sums_of(new)
        (new / tasks.SUMS).write_text("\n".join(sums) + "\n", encoding="utf-8")
        # Of questions and inputs alone: truths of versions may differ by a metre.
        inputs = "\n".join(line for line in sums if not line.endswith(f"  {tasks.TASK}"))
        digest_now = hashlib.sha256(inputs.encode()).hexdigest()
        if recipe.digest not in ("", digest_now):
            expected = f"digest: expected {recipe.digest}, got {digest_now}: other sources"
            raise InputError(f"{recipe.name}: {expected}")
    return len(questions)


def check_free(folder: Path, name: str) -> None:
    """Raise InputError for a file, and for a folder that is not empty and has no file of a name."""
    if folder.is_dir() and ((folder / name).is_file() or not any(folder.iterdir())):
        return
    if folder.exists():
        raise InputError(f"{folder}: expected a new folder, an empty one or one with {name}, got another")


def write_truth(folder: Path, questions: Sequence[Question], truth: pd.DataFrame, measured: Weather) -> str:
    """Write the truth and the storms of the weeks after each t; return the truth's SHA-256."""
    cells = truth.to_numpy()
    rows = [(*row, *_rounded(numbers)) for row, numbers in zip(questions, cells, strict=True)]
    tasks.write_csv(folder / tasks.TRUTH, (*tasks.QUESTION, *truth.columns), rows)
    weeks = [(t, _strongest(measured, epochs.mjd(t))) for t in sorted({row[1] for row in questions})]
    tasks.write_csv(folder / tasks.WEEKS, ("t", "highest_ap"), weeks)
    return tasks.digest(folder / tasks.TRUTH)


def _strongest(measured: Weather, t: float) -> str:
    """Return the highest daily Ap of the week after a time, a modified Julian day; '' where not measured."""
    first = int(t) - measured.first
    days = measured.kp[INTERVALS * first : INTERVALS * (first + _WEEK + 1)]
    if len(days) < INTERVALS * (_WEEK + 1):
        return ""
    return f"{ap_of_kp(days).reshape(-1, INTERVALS).mean(axis=1).max():.0f}"


def utc_text(morning: float) -> str:
    """Return a modified Julian day as UTC text, to the minute."""
    minutes = round(morning % 1.0 * 1440.0)
    return f"{epochs.calendar(morning)}T{minutes // 60:02d}:{minutes % 60:02d}:00"


def _rounded(numbers: np.ndarray) -> list[str]:
    """Return a row of a truth with fewer digits than machines agree on, so that its digest is one.

    Those of states that are known to metres have metres.
    """
    digits = [4] * 3 + [7] * 3 if len(numbers) == len(tasks.STATE) else [0] * 3 + [3] * 3 + [0] * 6
    return [f"{value:.{count}f}" for value, count in zip(numbers, digits, strict=True)]


def _write_weather(path: Path, known: Weather) -> None:
    """Write the whole days of measured weather, with the mean flux of the days before, in CSSI's format."""
    count = min(len(known.flux), len(known.kp) // INTERVALS)
    first = max(MEAN_DAYS, count - _WEATHER_DAYS)
    lines = [
        "# Kp: GFZ Potsdam, CC BY 4.0; F10.7: DRAO, Penticton. The mean flux is that of the last 81 days.",
        ",".join(["DATE", *KP, "F10.7_OBS", "F10.7_DATA_TYPE", "F10.7_OBS_CENTER81"]),
    ]
    for day in range(first, count):
        kp = (f"{round(10.0 * value)}" for value in known.kp[INTERVALS * day : INTERVALS * (day + 1)])
        mean = known.flux[day - MEAN_DAYS + 1 : day + 1].mean()
        figures = [*kp, f"{known.flux[day]:.1f}", "OBS", f"{mean:.1f}"]
        lines.append(",".join([epochs.calendar(known.first + day), *figures]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
