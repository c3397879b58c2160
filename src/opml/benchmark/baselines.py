"""Baselines: what a task's own inputs give without effort, written as answers that any tool could give.

Each reads the folder of t alone, and optionally a model. `predict` answers as `opml predict` does.
All others propagate sets by SGP4; along the track sigmas come from the predictions of the mornings before t,
radially and across from what sets usually err by.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml import __version__
from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath, check_distinct_files, replacing, suffix_of, write_text
from opml.base.progress import Progress
from opml.benchmark import tasks
from opml.benchmark.answers import COVARIANCE, REQUIRED, about_file
from opml.benchmark.tasks import BenchmarkTask
from opml.element_sets import corrector, improve, set_errors, trained_model as models, weighting
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.prediction import PublicMorning
from opml.element_sets.trained_model import CatalogueModel
from opml.element_sets.weighting import DENSITY, UNCHANGED
from opml.interop.element_sets import known_sets, mean_elements, sgp4_errors
from opml.interop.element_sets.element_set import changed, seconds_since
from opml.interop.predicted_orbit import LEADS
from opml.orbits.elements import rsw_rotation

_MORNINGS = 20
"""Mornings before t that are replayed; the weather and the histories of frozen tasks reach for few more."""

_UPPER = np.triu_indices(3)


PREDICT = "predict"  # the baseline of `opml predict`
IMPROVE, LEARNED = "improve", "learned"  # as `opml improve` does; by the model alone

SGP4 = "sgp4"  # the sets as published

BASELINES = (PREDICT, SGP4, DENSITY, IMPROVE, LEARNED)


def _check_written(path: FilePath, task: BenchmarkTask, trained: FilePath | None) -> None:
    """Raise InputError for a file of answers that is no CSV, that is read, or inside the task."""
    suffix_of(path, [".csv"])
    check_distinct_files([path, about_file(Path(path))], [trained] if trained else [])
    if task.folder.resolve() in Path(path).resolve().parents:
        raise InputError(f"{path}: expected a file outside {task.folder}, the task")


def write(
    path: FilePath, task: BenchmarkTask, baseline: str, trained: FilePath | None, progress: Progress
) -> int:
    """Write a baseline's answers as CSV, and a file about their making; return how many.

    baseline: one of BASELINES
    trained: a model of `opml train`; None: that of the package

    Raises InputError for inputs that cannot be read.
    """
    if baseline not in BASELINES:
        raise InputError(f"answer: expected {', '.join(BASELINES)}, got {baseline}")
    _check_written(path, task, trained)
    if any(task.folder.glob(f"{tasks.INPUTS}/*/*.tdm")):
        raise InputError(f"{task.name}: expected a task of element sets, got tracks: benchmark/track_fits.py")
    lines: list[list[str]] = []
    model, first = models.read(trained), process_time()
    hindsight = "" if baseline == SGP4 else models.hindsight(model.card, task.questions["t"].min())
    if hindsight:
        progress(hindsight)
    for t, questions in task.questions.groupby("t", sort=True):
        begin = process_time()
        if baseline == PREDICT:
            lines += _predicted(task, str(t), questions, trained)
        else:
            lines += _answers(task, str(t), questions, baseline, model)
        progress(f"{t}: {len(questions)} answers in {process_time() - begin:.1f} s")
    with replacing(path) as temporary:
        tasks.write_csv(temporary, (*REQUIRED, *COVARIANCE), lines)
    about = {
        "tool": f"opml {__version__}: {baseline}",
        "command": f"opml answer {task.name} {baseline}{f' --model {Path(trained).name}' if trained else ''}",
        "runtime_s": round(process_time() - first, 1),
        "hindsight": hindsight,
    }
    write_text(about_file(Path(path)), json.dumps(about, indent=1) + "\n")
    return len(lines)


def _predicted(
    task: BenchmarkTask, t: str, questions: pd.DataFrame, trained: FilePath | None
) -> Iterator[list[str]]:
    """Yield the rows of the answers to the questions of a time, as `opml predict` has them."""
    folder = task.inputs(t)
    sets = [folder / "sets.tle"]
    morning = PublicMorning.read(
        sets, date=t, weather=folder / "weather.csv", trained=trained, latency=task.latency
    )
    histories = known_sets.by_object(sets)
    asked = [(int(number), rows["time"]) for number, rows in questions.groupby("object", sort=False)]
    orbits = morning.predict_side_by_side(
        [histories[number] for number, _ in asked], days=LEADS[-1] + set_errors.REACH
    )
    for (number, times), orbit in zip(asked, orbits, strict=True):
        if isinstance(orbit, InputError):
            raise orbit
        for when in times:
            states, covariance = orbit.state(when), orbit.covariance(when)[:3, :3]
            yield [str(number), t, when, "GCRF", *_cells(states, covariance)]


def _answers(
    task: BenchmarkTask, t: str, questions: pd.DataFrame, baseline: str, model: CatalogueModel
) -> list[list[str]]:
    """Return the rows of the answers to the questions of a time."""
    folder = task.inputs(t)
    weather = str(folder / "weather.csv")
    known = improve.read([folder / "sets.tle"], date=t, weather=weather, latency=task.latency)
    now = _corrections(known, model, baseline)
    satellites = _corrected(known.catalogue.newest(), now)
    sigmas = now.set_index(["number", "lead"])["sigma"].to_dict()
    return [
        [str(number), t, when, "GCRF", *_state(satellites[number], when, sigmas.get((number, lead)))]
        for number, _, lead, when in questions[[*tasks.QUESTION]].itertuples(index=False)
    ]


def _corrections(known: improve.PublicData, model: CatalogueModel, baseline: str) -> pd.DataFrame:
    """Return the rows of `improve.replayed` on the date, with correction and sigma [m], NaN where unknown."""
    today = epochs.mjd(known.date)
    rows = improve.replayed(known, model, np.arange(-_MORNINGS, 1) + today)
    is_now = rows["morning"] == today
    if baseline in (IMPROVE, LEARNED):
        tried = weighting.candidates(rows, model.correctors, corrector.jumps(rows))
        if baseline == LEARNED:
            tried = {name: value for name, value in tried.items() if name not in (UNCHANGED, DENSITY)}
        # The candidates count by the object's past, where nothing speaks against it.
        why = improve.reasons(known.catalogue, known.catalogue.newest().by_number, rows, date=today)
        weights = improve.where_usable(weighting.weights(rows, tried), why)
        combined = weighting.combined(rows, tried, weighting.of_objects(weights, rows))
    else:
        correction = rows["density"] * float(baseline == DENSITY)
        # Sigmas held the errors of their lead on the mornings before, in scales.
        off = ((rows["error"] - correction).abs() / rows["scale"]).where(rows["is_fit"] & ~is_now)
        size = off.groupby(rows["lead"]).quantile(corrector.LEVEL) / corrector.NORMAL
        sigma = rows["lead"].map(size) * rows["scale"]
        combined = pd.DataFrame({"correction": correction, "sigma": sigma})
    columns = ["number", "lead", "tau", "response"]
    return rows.loc[is_now, columns].join(combined[["correction", "sigma"]])


def _corrected(newest: ElementCatalogue, now: pd.DataFrame) -> dict[int, Satrec]:
    """Return the newest sets with better numbers, by object; without drag they stay, as `opml improve`'s."""
    table = newest.by_number
    has_drag = now["number"].map(table["bstar"]).gt(0.0)
    better = improve.numbers(table, now[np.isfinite(now["correction"]) & has_drag])
    return {
        int(number): changed(satellite, *map(float, better.loc[number]))
        for number, satellite in zip(table.index, newest.satellites, strict=True)
    }


def _state(satellite: Satrec, time: str, sigma: float | None) -> list[str]:
    """Return the cells of a GCRF state [m, m/s] at a UTC text and of its position's covariance [m2].

    sigma: along the track [m]; None or NaN: what sets usually err by
    """
    state = mean_elements.state(satellite, epoch=time)
    days = (tasks.seconds([time], time) - seconds_since(tasks.EPOCH, [satellite])) / DAY
    sizes = sgp4_errors.usual_sigmas(satellite, days)[0]
    if sigma is not None and np.isfinite(sigma):
        sizes[1] = sigma
    return _cells(state, np.diag(sizes**2))


def _cells(state: np.ndarray, covariance: np.ndarray) -> list[str]:
    """Return the cells of a GCRF state [m, m/s] and of its position's covariance in RSW (3, 3) [m2]."""
    axes = rsw_rotation(state)
    covariance = axes.T @ covariance @ axes
    return [f"{value:.6f}" for value in state] + [f"{value:.9g}" for value in covariance[_UPPER]]
