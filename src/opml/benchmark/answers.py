"""Answers to a task, of any tool: CSV files, or OEM with a segment for each object and t.

A CSV has the columns object, t, time, frame (GCRF or TEME), x, y, z [m], vx, vy, vz [m/s], and where the
tool knows how sure it is cov_x_x, cov_x_y, cov_x_z, cov_y_y, cov_y_z, cov_z_z [m2]; further columns are
ignored. A segment of an OEM begins at t, and its OBJECT_ID or OBJECT_NAME is the catalogue number.
`about.json` in a folder, or `mine.about.json` next to `mine.csv`, may name tool, command and runtime_s.
"""

import csv
import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.benchmark import tasks
from opml.benchmark.tasks import STATE, BenchmarkTask
from opml.interop import known_orbits
from opml.interop.element_sets.teme import teme_to_gcrf
from opml.orbits.elements import rsw_rotation

COVARIANCE = ("cov_x_x", "cov_x_y", "cov_x_z", "cov_y_y", "cov_y_z", "cov_z_z")
"""Columns of the upper triangle of a position's covariance."""

REQUIRED = ("object", "t", "time", "frame", *STATE)  # columns that a CSV has

FRAMES = ("GCRF", "TEME")

_SAME = 1e-5  # [s]
_NEAREST, _FARTHEST = 6e6, 1e9  # from the Earth's centre [m]
_SLOWEST, _FASTEST = 100.0, 12e3  # [m/s]
_UPPER = np.triu_indices(3)


@dataclass(frozen=True, eq=False)
class Answers:
    """Answers to the questions of a task.

    covariances: (questions, 3, 3) of positions in RSW of the states [m2], NaN without one
    """

    states: np.ndarray  # (questions, 6) in GCRF [m, m/s], NaN without an answer
    covariances: np.ndarray
    stray: list[str]  # answers to no question, a line each
    about: dict[str, Any]  # contents of `about.json`
    digest: str  # SHA-256 of the files

    @property
    def is_answered(self) -> np.ndarray:
        """Return which questions (n,) have a state."""
        return np.asarray(np.isfinite(self.states).all(axis=1))

    def among(self, rows: np.ndarray) -> "Answers":
        """Return the answers to some of the questions."""
        kept = {name: getattr(self, name)[rows] for name in ("states", "covariances")}
        return replace(self, **kept)


def read(path: FilePath, task: BenchmarkTask) -> Answers:
    """Read the answers to a task in a file, or in the files of a folder.

    Raises InputError, naming file and line, for what is malformed, and for a question answered twice.
    """
    files = _files(Path(path))
    questions = _Questions(task)
    for file in files:
        (_read_csv if ".csv" in file.suffixes else _read_oem)(file, questions)
    about = _read_about(about_file(Path(path)))
    digests = "".join(tasks.digest(file) for file in files)
    digest = digests if len(files) == 1 else hashlib.sha256(digests.encode()).hexdigest()
    return Answers(questions.states, questions.covariances, questions.stray, about, digest)


def about_file(path: Path) -> Path:
    """Return the file about the making of answers in a file or a folder."""
    return path / "about.json" if path.is_dir() else path.with_suffix(".about.json")


def _read_about(path: Path) -> dict[str, Any]:
    try:
        return dict(json.loads(path.read_text(encoding="utf-8"))) if path.is_file() else {}
    except (ValueError, TypeError) as error:
        raise InputError(f"{path}: expected a JSON object ({error})") from None


def _files(path: Path) -> list[Path]:
    if not path.exists():
        raise InputError(f"{path}: no such file")
    files = [path] if path.is_file() else sorted(path.glob("*"))
    answers = [file for file in files if {".csv", ".oem"} & set(file.suffixes)]
    if not answers:
        raise InputError(f"{path}: expected answers as .csv or .oem, got none")
    return answers


class _Questions:
    """The questions of a task, and the answers found so far."""

    def __init__(self, task: BenchmarkTask) -> None:
        questions = task.questions
        source = task.folder / tasks.QUESTIONS
        self.t, self.time = (tasks.seconds(questions[name].tolist(), source) for name in ("t", "time"))
        self.states = np.full((len(questions), 6), np.nan)
        self.covariances = np.full((len(questions), 3, 3), np.nan)
        self.stray: list[str] = []
        self._places: dict[tuple[int, int], list[int]] = {}
        for place, (number, t) in enumerate(zip(questions["object"], self.t, strict=True)):
            self._places.setdefault((int(number), round(t)), []).append(place)

    def of(self, number: int, t: float) -> list[int]:
        """Return the places of the questions of an object and t."""
        return self._places.get((number, round(t)), [])

    def at(self, number: int, t: float, time: float, where: str) -> int | None:
        """Return the place of the question of an answer's time; others become stray."""
        places = self.of(number, t)
        gaps = time - self.time[places]
        if places and abs(gap := gaps[np.argmin(np.abs(gaps))]) <= _SAME:
            return places[int(np.argmin(np.abs(gaps)))]
        nearest = (
            f"the nearest time of a question is {-gap:+.6g} s from it"
            if places
            else "not this object at this t"
        )
        self.stray.append(f"{where}: no question has this answer: {nearest}")
        return None

    def put(
        self, places: Sequence[int], states: np.ndarray, covariances: np.ndarray, where: str, path: Path
    ) -> None:
        """Take states (n, 6) and covariances (n, 3, 3) in their axes."""
        if np.isfinite(self.states[places]).all(axis=1).any():
            expected = "one answer to a question, of one tool"
            raise InputError(f"{path}: {where}: expected {expected}, got another before it")
        self.states[places], self.covariances[places] = states, covariances


def _check_orbits(states: np.ndarray, where: str, path: Path) -> None:
    """Raise InputError for states (n, 6) of no satellite, as in another unit; NaN is no answer."""
    distances, speeds = (np.linalg.norm(part, axis=1) for part in (states[:, :3], states[:, 3:]))
    is_off = (distances < _NEAREST) | (distances > _FARTHEST) | (speeds < _SLOWEST) | (speeds > _FASTEST)
    if is_off.any():
        raise InputError(f"{path}: {where}: expected a state of an orbit [m, m/s], got another")


def _read_oem(path: Path, questions: _Questions) -> None:
    for k, segment in enumerate(known_orbits.segments(path, epoch=tasks.EPOCH), start=1):
        number = segment.identity.number or int(segment.name if segment.name.isdecimal() else 0)
        places = questions.of(number, segment.t[0])
        where = f"segment {k}"
        if not places:
            questions.stray.append(
                f"{where}: object {number or segment.name}: no question is about it at its first time"
            )
            continue
        orbit = known_orbits.KnownOrbit(str(path), known_orbits.parts_of(segment))
        times = questions.time[places]
        states = orbit.at(times)
        _check_orbits(states, where, path)
        questions.put(places, states, orbit.covariances(times)[:, :3, :3], where, path)


def _read_csv(path: Path, questions: _Questions) -> None:
    try:
        rows = list(_rows(path))
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: expected comma-separated values in UTF-8 ({error})") from None
    lines = [line for line, _ in rows]
    t, time = (
        np.array([tasks.seconds([row[name].rstrip("Z")], path, line)[0] for line, row in rows])
        for name in ("t", "time")
    )
    turns = _turns([row["frame"] for _, row in rows], time, path, lines)
    has_covariance = bool(rows) and COVARIANCE[0] in rows[0][1]
    for k, (line, row) in enumerate(rows):
        number = _whole(path, line, row["object"])
        place = questions.at(number, t[k], time[k], f"line {line}: object {number}, {row['time']}")
        state = np.array([_number(path, line, row[name]) for name in STATE])
        _check_orbits(state[None], f"line {line}", path)
        turned = (turns[k] @ state.reshape(2, 3).T).T.ravel()
        covariance = np.full((3, 3), np.nan)
        if has_covariance and row[COVARIANCE[0]]:
            covariance = _covariance(path, line, row, turns[k], turned)
        if place is not None:
            questions.put([place], turned[None], covariance[None], f"line {line}", path)


def _rows(path: Path) -> Iterator[tuple[int, dict[str, str]]]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        reader = csv.DictReader(file)
        names = reader.fieldnames or []
        wanted = (*REQUIRED, *(COVARIANCE if {*COVARIANCE} & {*names} else ()))
        if wrong := [name for name in wanted if names.count(name) != 1]:
            got = ", ".join(names)
            raise InputError(f"{path}: expected the columns {', '.join(wrong)}, each once, got {got}")
        for row in reader:
            if None in row or None in row.values():
                raise InputError(f"{path}: line {reader.line_num}: expected {len(names)} cells: cut short?")
            yield reader.line_num, row


def _whole(path: Path, line: int, text: str) -> int:
    if not text.isdecimal():
        raise InputError(f"{path}: line {line}: object: expected a catalogue number, got '{text}'")
    return int(text)


def _number(path: Path, line: int, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{path}: line {line}: expected a number, got '{text}'") from None


def _turns(frames: Sequence[str], time: np.ndarray, path: Path, lines: Sequence[int]) -> np.ndarray:
    """Return the rotations (n, 3, 3) of states in their frames to GCRF."""
    for line, frame in zip(lines, frames, strict=True):
        if frame not in FRAMES:
            raise InputError(f"{path}: line {line}: frame: expected {' or '.join(FRAMES)}, got '{frame}'")
    turns = np.tile(np.eye(3), (len(frames), 1, 1))
    of_date = np.array([frame == "TEME" for frame in frames], dtype=bool)
    if of_date.any():
        turns[of_date] = teme_to_gcrf(tasks.EPOCH, time[of_date])
    return turns


def _covariance(
    path: Path, line: int, row: dict[str, str], turn: np.ndarray, state: np.ndarray
) -> np.ndarray:
    """Return a row's covariance (3, 3) in RSW of its GCRF state."""
    covariance = np.empty((3, 3))
    covariance[_UPPER] = covariance.T[_UPPER] = [_number(path, line, row[name]) for name in COVARIANCE]
    if not (np.isfinite(covariance).all() and np.linalg.eigvalsh(covariance)[0] > 0.0):
        raise InputError(f"{path}: line {line}: expected a covariance that is positive definite")
    axes = rsw_rotation(state) @ turn
    return np.asarray(axes @ covariance @ axes.T)
