"""A task: what was known at times t, and the later times for which states are predicted.

A folder has `task.json`, `questions.csv` (object, t, lead, time), `inputs/<t>/` with what was known at t, and
SHA256SUMS of all of them. The truth is a file in another folder; the task holds its digest.
"""

import csv
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath

FORMAT = "benchmark/v1"  # name and version of the format
SAMPLE = "SAMPLE"  # name of the simulated task that comes with the package

SAMPLES = {SAMPLE: "sample", "SAMPLE-TRACKS": "sample-tracks"}
"""Folders of the tasks that come with the package, by name."""

HIDDEN = "hidden"  # digest of a truth that is published later
EPOCH = "2000-01-01T12:00:00"  # UTC text from which times count

TASK, QUESTIONS, INPUTS, SUMS = "task.json", "questions.csv", "inputs", "SHA256SUMS"
"""Files and folders of a task."""

TRUTH, WEEKS = "truth.csv", "weeks.csv"
"""Files of its truth: states, and how stormy the week after each t was."""

QUESTION = ("object", "t", "lead", "time")
STATE = ("x", "y", "z", "vx", "vy", "vz")
SIGMAS = ("sigma_r", "sigma_s", "sigma_w")
OF_SET = ("set_r", "set_s", "set_w")

TRUE = (*STATE, *SIGMAS, *OF_SET)
"""Columns of a truth: GCRF state [m, m/s], its standard deviations in RSW, and what the later set that it is
from is off it by itself [m]; the last six are those of element sets."""

_PACKAGED = Path(__file__).parents[1] / "data" / "benchmark"


@dataclass(frozen=True, eq=False)
class BenchmarkTask:
    """A task with its questions."""

    folder: Path  # of the task
    name: str
    title: str
    latency: float
    truth_digest: str
    questions: pd.DataFrame  # columns object (catalogue number), t and time (UTC texts), lead [d]

    def inputs(self, t: str) -> Path:
        """Return the folder of what was known at a time of the questions."""
        return self.folder / INPUTS / folder_name(t)

    def among(self, rows: np.ndarray) -> "BenchmarkTask":
        """Return the task of some of its questions."""
        return replace(self, questions=self.questions[rows].reset_index(drop=True))


def folder_name(t: str) -> str:
    """Return the name of the folder of inputs of a UTC text."""
    return t.replace(":", "")


def digest(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def seconds(texts: Sequence[str], path: FilePath, first_line: int = 2) -> np.ndarray:
    """Return times (n,) [s since EPOCH] of UTC texts. Raises InputError that names file and line."""
    known: dict[str, float] = {}
    for line, text in enumerate(texts, start=first_line):
        if text not in known:
            try:
                known[text] = epochs.seconds_between(EPOCH, text)
            except InputError as error:
                raise InputError(f"{path}: line {line}: {error}") from None
    return np.array([known[text] for text in texts], dtype=float)


def read(folder: FilePath) -> BenchmarkTask:
    """Read a task, SAMPLE or a folder.

    Raises InputError for a folder that holds none, and for a file that is not as SHA256SUMS has it.
    """
    place = _PACKAGED / SAMPLES[str(folder)] if str(folder) in SAMPLES else Path(folder)
    if not (place / TASK).is_file():
        raise InputError(f"{folder}: expected a task with {TASK}, got none: `opml docs benchmark`")
    _check_sums(place)
    try:
        facts = json.loads((place / TASK).read_text(encoding="utf-8"))
        if facts["format"] != FORMAT:
            raise InputError(f"{place / TASK}: format: expected {FORMAT}, got {facts['format']}")
        return BenchmarkTask(
            place, facts["name"], facts["title"], facts["latency_hours"] / 24.0, facts["truth_sha256"],
            pd.read_csv(place / QUESTIONS, dtype={"t": str, "time": str})[[*QUESTION]],
        )  # fmt: skip
    except (KeyError, TypeError, ValueError) as reason:
        raise InputError(f"{folder}: expected {TASK} and {QUESTIONS} of a task, got {reason!r}") from None


def sums_of(folder: Path) -> list[str]:
    """Return the lines of SHA256SUMS of a folder, as sha256sum writes them."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != SUMS)
    return [f"{digest(path)}  {path.relative_to(folder).as_posix()}" for path in files]


def _check_sums(folder: Path) -> None:
    path = folder / SUMS
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    for line in path.read_text(encoding="utf-8").splitlines():
        expected, _, name = line.partition("  ")
        file = folder / name
        if not file.is_file() or digest(file) != expected:
            raise InputError(f"{file}: expected the file of SHA-256 {expected[:12]}, got another or none")


def read_truth(task: BenchmarkTask, folder: FilePath | None) -> pd.DataFrame:
    """Return the columns TRUE of a task's questions, states NaN where a hidden one has none.

    folder: of the truth; None: that of the package, or next to the task under its name and `-truth`

    Raises InputError for a file that is missing or not the one the task was frozen with.
    """
    path = _truth_folder(task, folder) / TRUTH
    if not path.is_file():
        raise InputError(f"{path}: expected the truth of {task.name}, got none: --truth")
    if task.truth_digest not in (HIDDEN, digest(path)):
        raise InputError(f"{path}: expected the truth that {task.name} was frozen with, got another")
    truth = pd.read_csv(path, dtype={"t": str, "time": str})
    return task.questions.merge(truth, how="left", on=[*QUESTION]).reindex(columns=[*TRUE]).astype(float)


def read_weeks(task: BenchmarkTask, folder: FilePath | None) -> np.ndarray:
    """Return the highest daily Ap (n,) in the week after the t of each question, NaN where unknown."""
    path = _truth_folder(task, folder) / WEEKS
    weeks = pd.read_csv(path, dtype={"t": str}).set_index("t")["highest_ap"] if path.is_file() else {}
    return np.asarray(task.questions["t"].map(weeks), dtype=float)


def _truth_folder(task: BenchmarkTask, folder: FilePath | None) -> Path:
    return task.folder.with_name(f"{task.folder.name}-truth") if folder is None else Path(folder)


def write_csv(path: Path, header: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Write a table with numbers in the shortest form that gives them back."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
