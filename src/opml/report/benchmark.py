"""The page of a score: what answers to a task of the benchmark are worth."""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.files import FilePath, suffix_of, write_text
from opml.benchmark import scores, suspicions, tasks
from opml.benchmark.answers import read as read_answers
from opml.benchmark.scores import AXES, LEVEL, STORM
from opml.benchmark.tasks import OF_SET, STATE
from opml.report import texts
from opml.report.document import Block, as_it_is, html_page, items
from opml.report.results import NO_VALUE, rounded_cell

SUFFIXES = (".html", ".json", ".tsv")  # forms of a score


@dataclass(frozen=True, eq=False)
class Score:
    """The score of a task's answers.

    scores, by_weather: of `opml.benchmark.scores`
    """

    task: str
    title: str
    tool: str
    digest: str
    scores: pd.DataFrame
    by_weather: pd.DataFrame
    of_sets: Mapping[str, float]  # medians by axis [m] of later sets minus a truth that is made of sets
    suspicions: Sequence[str]  # a sentence each
    about: Mapping[str, Any]  # tool, command and runtime_s, where stated

    def values(self) -> dict[str, Any]:
        """Return all of it as JSON values."""
        return {
            "task": self.task,
            "tool": self.tool,
            "answers_sha256": self.digest,
            "scores": _records(self.scores),
            "by_weather": _records(self.by_weather),
            "later_sets_off_the_truth": dict(self.of_sets),
            "suspicions": [*self.suspicions],
            "about": dict(self.about),
        }

    def line(self) -> dict[str, str]:
        """Return the cells of the line for the board."""
        row = self.scores.set_index("lead")
        medians = {f"{lead} d [m]": _with_interval(row.loc[lead], "along_track_median") for lead in row.index}
        last = row.iloc[-1]
        lead = row.index[-1]
        return {
            "task": self.task,
            "tool": self.tool,
            "answered [%]": rounded_cell(float(row["answered"].mean())),
            **medians,
            f"95 % at {lead} d [m]": rounded_cell(last["along_track_p95"]),
            f"R at {lead} d [m]": rounded_cell(last["radial_median"]),
            f"W at {lead} d [m]": rounded_cell(last["cross_track_median"]),
            f"CRPS at {lead} d [m]": rounded_cell(last["along_track_crps"]),
            f"log score at {lead} d": rounded_cell(last["along_track_log_score"], 2),
            f"inside {100 * LEVEL:g} % at {lead} d": _with_interval(last, "along_track_inside"),
            "runtime [s]": rounded_cell(float(self.about.get("runtime_s", math.nan))),
            "SHA-256": self.digest[:12],
            "command": str(self.about.get("command", NO_VALUE)),
        }


def score(task: FilePath, answers: FilePath, truth: FilePath | None = None) -> Score:
    """Return the score of answers to a task.

    task: folder, or SAMPLE
    answers: file or folder
    truth: folder; None: that of the package, or next to the task

    Raises InputError for files that cannot be read.
    """
    frozen = tasks.read(task)
    true = tasks.read_truth(frozen, truth)
    given = read_answers(answers, frozen)
    judged = true[[*STATE]].notna().all(axis=1).to_numpy()  # a hidden question may have no later set
    questions, given, true = frozen.among(judged), given.among(judged), true[judged]
    weeks = tasks.read_weeks(frozen, truth)[judged]
    errors = scores.errors(questions, given, true)
    return Score(
        questions.name,
        questions.title,
        str(given.about.get("tool", Path(answers).stem)),
        given.digest,
        scores.scores(questions, errors),
        scores.by_weather(errors.assign(highest_ap=weeks[given.is_answered])),
        true[[*OF_SET]].abs().median().dropna().to_dict(),
        suspicions.sentences(questions, given, errors, true[[*STATE]].to_numpy()),
        given.about,
    )


def text(score: Score) -> str:
    """Return what a terminal shows: the errors along the track by lead, and what is suspicious."""
    inside = f"inside {100 * LEVEL:g} % [%]"
    header = ("lead [d]", "answered [%]", "median [m]", "95 % [m]", "CRPS [m]", "log score", inside)
    rows = [
        [cells[0], *cells[2:]] for cells in (_cells(row, AXES["s"]) for _, row in score.scores.iterrows())
    ]
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    table = ["  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True)) for row in (header, *rows)]
    weeks = [
        f"{row.weeks} weeks, {row.lead} d: median {rounded_cell(row.median)} m (n = {row.answers})"
        for row in score.by_weather.itertuples()
    ]
    return "\n".join([f"{score.task}, along the track: {score.tool}", *table, *weeks, *score.suspicions])


def board_lines(score: Score) -> str:
    """Return the header and the line of the board, tab-separated."""
    cells = score.line()
    return (
        "\n".join("\t".join(" ".join(text.split()) for text in row) for row in (cells, cells.values())) + "\n"
    )


def document(score: Score) -> list[Block]:
    """Return the page."""
    return [
        f"# {score.task}: {as_it_is(score.tool)}",
        as_it_is(score.title),
        "## Findings",
        items(map(as_it_is, score.suspicions)) or "Nothing of the answers is suspicious.",
        *texts.blocks("benchmark.scores", level=100 * LEVEL),
        *(texts.blocks("benchmark.truth", **score.of_sets) if score.of_sets else ()),
        *(block for name in AXES.values() for block in _axis_table(score.scores, name)),
        *_weeks_table(score.by_weather),
        f"Answers' SHA-256: `{score.digest}`",
    ]


def _axis_table(scores: pd.DataFrame, name: str) -> Iterator[Block]:
    rows = [_cells(row, name) for _, row in scores.iterrows()]
    return texts.blocks("benchmark.axis", rows, axis=name.replace("_", "-"))


def _cells(row: "pd.Series[Any]", name: str) -> list[str]:
    return [
        *(rounded_cell(row[key]) for key in ("lead", "questions", "answered")),
        _with_interval(row, f"{name}_median"),
        rounded_cell(row[f"{name}_p95"]),
        rounded_cell(row[f"{name}_crps"]),
        rounded_cell(row[f"{name}_log_score"], 2),
        _with_interval(row, f"{name}_inside"),
    ]


def _with_interval(row: "pd.Series[Any]", key: str) -> str:
    if not math.isfinite(row.get(f"{key}_low", math.nan)):
        return rounded_cell(row[key])
    return (
        f"{rounded_cell(row[key])} ({rounded_cell(row[f'{key}_low'])} to {rounded_cell(row[f'{key}_high'])})"
    )


def _weeks_table(table: pd.DataFrame) -> Iterator[Block]:
    keys = ("lead", "answers", "median", "p95", "crps", "inside")
    rows = [[row["weeks"], *(rounded_cell(row[key]) for key in keys)] for row in table.to_dict("records")]
    return texts.blocks("benchmark.weather", rows, storm=STORM)


def _records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Return rows as JSON values, None for what is not finite."""
    finite = table.replace([np.inf, -np.inf], np.nan)
    return finite.astype(object).where(finite.notna(), None).to_dict("records")


def write(path: FilePath, score: Score) -> None:
    """Write a score as a page, JSON or the line of a board, by the suffix, whole or not at all."""
    title = f"{score.task}: {score.tool}"
    texts: dict[str, Callable[[], str]] = {
        ".html": lambda: html_page(document(score), title=title),
        ".json": lambda: json.dumps(score.values(), indent=1) + "\n",
        ".tsv": lambda: board_lines(score),
    }
    text = texts[suffix_of(path, SUFFIXES)]()
    write_text(path, text)
