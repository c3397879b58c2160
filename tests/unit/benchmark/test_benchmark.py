"""Tasks, answers and scores of the benchmark, on the sample that comes with the package."""

import csv
import hashlib
import json
import math
import re
import runpy
import shutil
import sys
from dataclasses import replace
from datetime import date
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import sinking_histories
from data_server import serving
from support import REPOSITORY, refusal, refusals

from opml import cli
from opml.base.errors import InputError
from opml.benchmark import answers, baselines, recipes, set_truths, task_folders, tasks
from opml.benchmark.scores import errors
from opml.environment import solar_activity
from opml.environment.weather import Weather
from opml.interop import oem
from opml.interop.element_sets.teme import teme_to_gcrf
from opml.interop.ephemeris import Ephemeris
from opml.report import benchmark

SAMPLE = REPOSITORY / "src" / "opml" / "data" / "benchmark" / "sample"


def true_states(task):
    return tasks.read_truth(task, None)[[*tasks.STATE]].to_numpy()


@pytest.fixture(scope="module")
def task():
    return tasks.read(tasks.SAMPLE)


@pytest.fixture(scope="module")
def truth(task):
    return true_states(task)


@pytest.fixture(scope="module")
def sgp4(task, tmp_path_factory):
    path = tmp_path_factory.mktemp("answers") / "sgp4.csv"
    assert baselines.write(path, task, "sgp4", None, print) == len(task.questions)
    return path


def edited_rows(path, folder, edit):
    """Answers whose rows, dictionaries of texts, are as `edit` returns them."""
    with path.open(newline="") as file:
        rows = edit(list(csv.DictReader(file)))
    changed = folder / "edited.csv"
    with changed.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    return changed


def suspicions(path, name=tasks.SAMPLE):
    return benchmark.score(name, path).suspicions


@pytest.fixture(scope="module", params=tasks.SAMPLES)
def any_task(request):
    return request.param, tasks.read(request.param)


@pytest.fixture(scope="module")
def any_truth(any_task):
    return true_states(any_task[1])


# Scores


def lines_of(path):
    """The lines of a CSV, by column."""
    return list(csv.DictReader(path.read_text().splitlines()))


def by_hand(path):
    """Scores by lead and axis from the files alone, in plain Python but for the quantiles."""
    truth = {(r["object"], r["t"], r["lead"]): r for r in lines_of(SAMPLE.parent / "sample-truth/truth.csv")}
    asked = {(r["object"], r["t"], r["time"]): r["lead"] for r in lines_of(SAMPLE / "questions.csv")}
    found = {}
    for row in lines_of(path):
        lead = asked[row["object"], row["t"], row["time"]]
        true = truth[row["object"], row["t"], lead]
        p, v = ([float(true[name]) for name in names] for names in (("x", "y", "z"), ("vx", "vy", "vz")))
        a, w = ([float(row[name]) for name in names] for names in (("x", "y", "z"), ("vx", "vy", "vz")))
        radius = math.hypot(*p)
        axes, own = axes_of(p, v), axes_of(a, w)
        up, ahead, across = (dot(axis, a) for axis in axes)
        error = {
            "radial": math.hypot(up, ahead) - radius,
            "along_track": radius * math.atan2(ahead, up),
            "cross_track": across,
        }
        names = "xyz"
        cov = [[float(row[f"cov_{min(i, j)}_{max(i, j)}"]) for j in names] for i in names]
        for name, axis in zip(("radial", "along_track", "cross_track"), own, strict=True):
            variance = dot(axis, [dot(line, axis) for line in cov])
            found.setdefault((int(lead), name), []).append((error[name], math.sqrt(variance)))
    return found


def dot(a, b):
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def axes_of(p, v):
    r = [x / math.hypot(*p) for x in p]
    h = cross(p, v)
    w = [x / math.hypot(*h) for x in h]
    return r, cross(w, r), w


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def integrated_crps(error, sigma):
    """The CRPS by its definition: the squared distance of the distribution from the step at the truth.

    Over 16 deviations about mean and truth, by Gauss-Legendre on both sides of the step.
    """
    z = error / sigma  # of the mean from the truth: the truth lies at -z
    nodes, weights = np.polynomial.legendre.leggauss(120)
    total = 0.0
    for low, high, step in ((min(-12.0, -z - 12.0), -z, 0.0), (-z, max(12.0, -z + 12.0), 1.0)):
        cuts = np.linspace(low, high, 1 + max(1, math.ceil(high - low)))
        for a, b in pairwise(cuts):
            x = 0.5 * (b - a) * nodes + 0.5 * (a + b)
            cdf = np.array([0.5 * math.erfc(-one / math.sqrt(2.0)) for one in x])
            total += 0.5 * (b - a) * float(weights @ (cdf - step) ** 2)
    return sigma * total


def test_scores_are_those_by_hand(sgp4):
    scores = benchmark.score(tasks.SAMPLE, sgp4).scores.set_index("lead")
    found = by_hand(sgp4)
    assert len(found) == 12
    for (lead, name), pairs in found.items():
        row = scores.loc[lead]
        size = sorted(abs(error) for error, _ in pairs)
        expected = {
            "median": np.median(size),
            "p95": np.percentile(size, 95.0),
            "crps": math.fsum(integrated_crps(*pair) for pair in pairs) / len(pairs),
            "log_score": -math.fsum(
                math.log(math.exp(-0.5 * (e / s) ** 2) / (s * math.sqrt(2.0 * math.pi))) for e, s in pairs
            )
            / len(pairs),
            "inside": 100.0 * sum(abs(e) <= 1.6448536269514722 * s for e, s in pairs) / len(pairs),
        }
        for key, value in expected.items():
            assert row[f"{name}_{key}"] == pytest.approx(value, rel=1e-9, abs=1e-9), (lead, name, key)
        assert (row["questions"], row["answered"]) == (12, 100.0)


def test_without_covariances_there_are_errors_alone(sgp4, tmp_path):
    bare = edited_rows(
        sgp4, tmp_path, lambda rows: [{k: v for k, v in r.items() if "cov" not in k} for r in rows]
    )
    with_them, without = (benchmark.score(tasks.SAMPLE, path).scores for path in (sgp4, bare))
    assert with_them["along_track_median"].tolist() == without["along_track_median"].tolist()
    assert without[["along_track_crps", "along_track_log_score", "along_track_inside"]].isna().all(axis=None)


# What is wrong with answers


def test_of_honest_answers_nothing_is_told(sgp4):
    assert suspicions(sgp4) == []


def test_truncated_answers_are_told(sgp4, tmp_path):
    cut = edited_rows(sgp4, tmp_path, lambda rows: rows[:-3])
    (told,) = suspicions(cut)
    assert told.startswith("truncated: 3 of 48 questions have no answer (3 d: 1, 5 d: 1, 7 d: 1)")
    scores = benchmark.score(tasks.SAMPLE, cut).scores
    assert scores["answered"].tolist() == pytest.approx([100.0, *[100.0 * 11 / 12] * 3])


def test_a_line_that_is_cut_is_refused(sgp4, tmp_path):
    text = sgp4.read_text().splitlines()
    cut = tmp_path / "cut.csv"
    cut.write_text("\n".join([*text[:5], text[5][:60]]) + "\n")
    assert "cut.csv: line 6: expected 16 cells: cut short" in refusal(benchmark.score, tasks.SAMPLE, cut)


@pytest.mark.parametrize(("shift", "where"), [(37.0, "ahead of"), (-18.0, "behind")])
def test_states_at_other_times_are_told(shift, where, any_task, any_truth, tmp_path):
    name, task = any_task
    told = suspicions(of_states(flown(any_truth, shift, task), task, tmp_path), name)
    (sentence,) = [one for one in told if one.startswith("time:")]
    assert f" s {where} their times" in sentence
    assert float(sentence.split()[3]) == pytest.approx(abs(shift), rel=0.02)


def test_states_of_teme_called_gcrf_are_told(any_task, any_truth, tmp_path):
    name, task = any_task
    turns = teme_to_gcrf(tasks.EPOCH, tasks.seconds(task.questions["time"].tolist(), ""))
    near = any_truth + [30.0, 0.0, 20.0, 0.0, 0.0, 0.0]
    of_date = np.hstack([np.einsum("nji,nj->ni", turns, near[:, k : k + 3]) for k in (0, 3)])
    told = suspicions(of_states(of_date, task, tmp_path), name)
    assert any(one.startswith("frame: it seems that TEME states are called GCRF") for one in told)


def test_states_of_other_objects_are_told(any_task, any_truth, tmp_path):
    name, task = any_task
    told = suspicions(
        of_states(np.roll(any_truth, len(task.questions) // 2 + 1, axis=0), task, tmp_path), name
    )
    assert any(one.startswith("object: answers are ") for one in told)


def flown(truth, shift, task):
    """True states carried on a circle by a time [s], with some metres of error."""
    p, v = truth[:, :3], truth[:, 3:]
    angle = (np.linalg.norm(v, axis=1) / np.linalg.norm(p, axis=1) * shift)[:, None]
    ratio = (np.linalg.norm(p, axis=1) / np.linalg.norm(v, axis=1))[:, None]
    noise = np.resize([20.0, -30.0, 40.0, -10.0], len(p))[:, None]
    return np.hstack(
        [p * np.cos(angle) + v * ratio * np.sin(angle) + noise, v * np.cos(angle) - p / ratio * np.sin(angle)]
    )


def of_states(states, task, folder):
    """Answers of GCRF states (questions, 6)."""
    path = folder / "states.csv"
    rows = [
        [one.object, one.t, one.time, "GCRF", *map(repr, map(float, state))]
        for one, state in zip(task.questions.itertuples(), states, strict=True)
    ]
    tasks.write_csv(path, answers.REQUIRED, rows)
    return path


@pytest.mark.parametrize(("edit", "told"), refusals("answers"))
def test_malformed_answers_are_refused(edit, told, sgp4, tmp_path):
    wrong = edited_rows(sgp4, tmp_path, lambda rows: [rows[0] | edit, *rows[1:]])
    with pytest.raises(InputError, match="edited.csv: " + re.escape(told)):
        benchmark.score(tasks.SAMPLE, wrong)


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("mine.csv", b"\xff\xfe\x00", "mine.csv: expected comma-separated values in UTF-8"),
        ("mine.csv", b"object,t\n", "mine.csv: expected the columns time, frame"),
        (
            "mine.csv",
            ",".join([*answers.REQUIRED, "cov_z_z"]).encode(),
            "expected the columns cov_x_x, cov_x_y",
        ),
        ("mine.csv", ",".join([*answers.REQUIRED, "x"]).encode(), "expected the columns x, each once, got"),
        ("about.json", b"[1, 2", "about.json: expected a JSON object"),
        ("mine.txt", b"", "expected answers as .csv or .oem, got none"),
    ],
    ids=["bytes", "columns", "a part of a covariance", "a column twice", "about", "suffix"],
)
def test_files_that_hold_no_answers_are_refused(name, content, told, sgp4, task, tmp_path):
    if name == "about.json":
        shutil.copy(sgp4, tmp_path)
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=told):
        answers.read(tmp_path, task)


def test_a_question_is_answered_once(sgp4, tmp_path):
    twice = edited_rows(sgp4, tmp_path, lambda rows: [*rows, rows[0]])
    assert "line 50: expected one answer to a question" in refusal(benchmark.score, tasks.SAMPLE, twice)


# Answers in messages


def test_messages_score_as_tables_do(sgp4, task, tmp_path):
    told = answers.read(sgp4, task)
    segments = []
    t = tasks.seconds(task.questions["t"].tolist(), "")
    time = tasks.seconds(task.questions["time"].tolist(), "")
    for (number, _), places in task.questions.groupby(["object", "t"]).indices.items():
        states = told.states[places]
        covariances = np.tile(np.diag([1.0] * 6), (len(places), 1, 1))
        covariances[:, :3, :3] = told.covariances[places]
        segments.append(
            Ephemeris(
                str(number), np.append(t[places[0]], time[places]), np.vstack([states[:1], states]),
                time[places], covariances, covariance_frame="RSW", known=t[places[0]],
            )
        )  # fmt: skip
    oem.write(tmp_path / "mine.oem", segments, epoch=tasks.EPOCH)
    (tmp_path / "about.json").write_text(json.dumps({"tool": "mine 1.0", "runtime_s": 12.0}))
    score = benchmark.score(tasks.SAMPLE, tmp_path)
    assert (score.tool, score.suspicions) == ("mine 1.0", [])
    assert score.line()["runtime [s]"] == "12"
    expected = benchmark.score(tasks.SAMPLE, sgp4).scores
    np.testing.assert_allclose(score.scores, expected, rtol=1e-4, atol=1e-2)


# The command


def test_a_stranger_s_answers_are_those_of_sgp4(sgp4, tmp_path, monkeypatch, capsys):
    mine = tmp_path / "mine.csv"
    script = REPOSITORY / "benchmark" / "plain_sgp4.py"
    monkeypatch.setattr(sys, "argv", [str(script), str(SAMPLE), str(mine)])
    runpy.run_path(str(script))
    assert "opml" not in script.read_text()
    page = tmp_path / "mine.html"
    outputs = [f"-o{page}", f"-o{tmp_path / 'mine.json'}", f"-o{tmp_path / 'mine.tsv'}"]
    assert cli.main(["score", "SAMPLE", str(mine), *outputs]) == 0
    assert capsys.readouterr().out.startswith("sample, along the track: mine\n")
    values = json.loads((tmp_path / "mine.json").read_text())
    expected = benchmark.score(tasks.SAMPLE, sgp4)
    for row, other in zip(values["scores"], expected.scores.to_dict("records"), strict=True):
        assert row["along_track_median"] == pytest.approx(other["along_track_median"], abs=0.05)
        assert row["along_track_crps"] is None
    assert "cross-track, lead [d]" in page.read_text()
    header, line = (text.split("\t") for text in (tmp_path / "mine.tsv").read_text().splitlines())
    assert dict(zip(header, line, strict=True))["task"] == "sample"


def test_what_a_score_cannot_be_written_as_is_refused(sgp4, tmp_path, capsys):
    assert cli.main(["score", "SAMPLE", str(sgp4), "-o", str(tmp_path / "score.pdf")]) == 1
    assert "expected a suffix .html, .json, .tsv, got .pdf" in capsys.readouterr().err


@pytest.mark.parametrize("way", baselines.BASELINES)
def test_baselines_answer_all_that_is_asked(way, task, tmp_path, monkeypatch):
    sinking_histories.seek_coarsely(monkeypatch.setattr)
    last = task.questions[task.questions["t"] == task.questions["t"].max()]
    part = replace(task, questions=last.reset_index(drop=True))
    path = tmp_path / f"{way}.csv"
    assert baselines.write(path, part, way, None, print) == len(last)
    found = answers.read(path, part)
    assert found.is_answered.all()
    assert found.about["command"] == f"opml answer sample {way}"
    words = "" if way == baselines.SGP4 else "the model was trained on data up to"
    assert found.about["hindsight"][: len(words) or None] == words
    assert np.isfinite(found.covariances).all()
    true = true_states(task)[last.index]
    assert np.linalg.norm(found.states[:, :3] - true[:, :3], axis=1).max() < 200e3


def test_no_answers_are_written_into_a_task(tmp_path, capsys):
    shutil.copytree(SAMPLE, tmp_path / "sample")
    inside = tmp_path / "sample" / "questions.csv"
    assert cli.main(["answer", str(tmp_path / "sample"), "sgp4", "-o", str(inside)]) == 1
    assert "questions.csv: expected a file outside" in capsys.readouterr().err
    tasks.read(tmp_path / "sample")


# Tasks


def test_no_input_holds_what_is_asked(task):
    asked = task.questions.groupby("t")["object"].unique()
    epochs = {}
    for t, objects in asked.items():
        lines = (task.inputs(t) / "sets.tle").read_text().splitlines()[::2]
        assert {int(line[2:7]) for line in lines} == set(objects)
        for line in lines:
            day = np.datetime64(f"20{line[18:20]}-01-01") + np.timedelta64(
                round((float(line[20:32]) - 1.0) * 86400e3), "ms"
            )
            assert day <= np.datetime64(t) - np.timedelta64(6, "h")
            epochs.setdefault(int(line[2:7]), []).append((day, t))
        weather = (task.inputs(t) / "weather.csv").read_text().splitlines()
        assert weather[-1][:10] == str(np.datetime64(t[:10]) - 1)
    for one in task.questions.itertuples():
        after = np.datetime64(one.t), np.datetime64(one.time) + np.timedelta64(1, "h")
        assert [t for day, t in epochs[one.object] if after[0] < day < after[1]] == []


@pytest.mark.parametrize(("name", "told"), [("questions.csv", "questions.csv"), ("task.json", "task.json")])
def test_a_task_that_was_changed_is_refused(name, told, tmp_path):
    changed = tmp_path / "sample"
    shutil.copytree(SAMPLE, changed)
    (changed / name).write_text((changed / name).read_text() + "\n")
    with pytest.raises(InputError, match=f"{told}: expected the file of SHA-256"):
        tasks.read(changed)
    (changed / name).write_text("{")
    (changed / "SHA256SUMS").write_text("\n".join(tasks.sums_of(changed)))
    with pytest.raises(InputError, match=f"{re.escape(str(changed))}: expected task.json and questions.csv"):
        tasks.read(changed)


def test_another_truth_is_refused(task, tmp_path):
    assert "truth.csv: expected the truth of sample, got none" in refusal(tasks.read_truth, task, tmp_path)
    (tmp_path / "truth.csv").write_text("x,y,z,vx,vy,vz\n")
    assert "that sample was frozen with" in refusal(tasks.read_truth, task, tmp_path)


@pytest.fixture(scope="module")
def recipe():
    return recipes.read(REPOSITORY / "benchmark" / "sample.yaml")


def test_the_sample_is_what_its_recipe_makes(recipe, tmp_path):
    make = runpy.run_path(str(REPOSITORY / "tests" / "reference" / "benchmark_sample.py"))["make"]
    assert make(tmp_path) == 48
    assert (tmp_path / "sample" / "questions.csv").read_text() == (SAMPLE / "questions.csv").read_text()
    assert (tmp_path / "sample" / "inputs/2026-01-13T060000/weather.csv").read_text() == (
        SAMPLE / "inputs/2026-01-13T060000/weather.csv"
    ).read_text()


def test_a_task_of_other_sources_is_refused(recipe, tmp_path):
    sets = [
        SAMPLE / "inputs" / f"{day}T060000" / "sets.tle" for day in ("2025-12-30", "2026-01-06", "2026-01-13")
    ]
    early = recipe.evolve(first=date(2025, 12, 23), last=date(2025, 12, 23), groups=1)
    folder, judge = tmp_path / "task", set_truths.themselves
    folders = task_folders.Folders(folder, tmp_path / "truth")
    recipes.make(early, [*sets, *sets], folders, judge=judge)
    lines = (folder / "inputs/2025-12-23T060000/sets.tle").read_text().splitlines()
    assert len({*zip(lines[::2], lines[1::2], strict=True)}) == len(lines) / 2
    short = _until(tmp_path / "weather.csv", "2025-11-20")
    for made, weather, told in (
        (early.evolve(digest="0" * 64), "OBSERVED", "digest: expected 0000"),
        (early, short, "measured up to 2025-12-23"),
    ):
        with pytest.raises(InputError, match=told):
            recipes.make(made, sets, folders, weather, judge)


def _until(path, day):
    """The packaged weather up to a day."""
    lines = solar_activity.resolve("OBSERVED").read_text().splitlines(keepends=True)
    path.write_text("".join(line for line in lines if line[0] in "#D" or line[:10] < day))
    return path


@pytest.mark.parametrize("folder", ["sets", "sets/one.tle"])
def test_a_task_takes_the_place_of_no_other_files(folder, recipe, tmp_path):
    """Of element sets in a folder, say, that would be gone."""
    (tmp_path / "sets").mkdir()
    (tmp_path / "sets" / "one.tle").write_text("whatever it holds\n")
    for task, truth in ((tmp_path / folder, tmp_path / "new"), (tmp_path / "new", tmp_path / folder)):
        folders = task_folders.Folders(task, truth)
        told = refusal(recipes.make, recipe, [tmp_path / "sets"], folders)
        assert "expected a new folder, an empty one" in told
    assert (tmp_path / "sets" / "one.tle").is_file()


PINNED = """format: benchmark/v1
name: month
title: A month
first: 2026-01-03
last: 2026-01-03
every_days: 7
groups: 8
history_days: 48
source:
  address: {address}/
  files: {{sets.tle: {digest}}}
"""


def test_a_stranger_makes_a_task_answers_it_and_is_scored(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    sinking_histories.write(tmp_path / "all.tle", range(101, 133), 56)
    content = (tmp_path / "all.tle").read_bytes()
    with serving(monkeypatch, tmp_path / "data") as server:
        server.answers["/sets.tle"] = (200, content)
        recipe = PINNED.format(address=server.address, digest=hashlib.sha256(content).hexdigest())
        Path("month.yaml").write_text(recipe)
        assert cli.main(["task", "month.yaml", "-o", "month"]) == 0
        monkeypatch.setattr(sys, "argv", ["plain_sgp4.py", "month", "mine.csv"])
        runpy.run_path(str(REPOSITORY / "benchmark" / "plain_sgp4.py"))
        assert cli.main(["score", "month", "mine.csv", "-o", "mine.html", "-o", "mine.json"]) == 0
        truth = tasks.read_truth(tasks.read("month"), None)
        off = json.loads(Path("mine.json").read_text())["later_sets_off_the_truth"]
        assert off == pytest.approx(truth[[*tasks.OF_SET]].abs().median().to_dict())
        # An orbit under full forces has periods that SGP4 has not: some hundred metres, not kilometres.
        assert truth[[*tasks.OF_SET]].abs().max(axis=None) < 3e3
        assert (truth[[*tasks.SIGMAS]] > 1.0).all(axis=None)
        page = " ".join(Path("mine.html").read_text().split())
        assert f"such a set is {off['set_r']:.0f} m off it radially" in page
        assert [path.read_bytes() for path in recipes.read("month.yaml").source.fetch()] == [content]
        assert server.asked() == ["/sets.tle"]
        file, digest = f"{server.address}/sets.tle", recipe.split()[-1][:12]
        for answer, told in (
            ((200, b"1 cut"), f"expected the file of SHA-256 {digest}, got another: '1 cut': {file}"),
            ((404, b"gone"), f"{file}: expected an answer 200, got 404: gone"),
        ):
            (tmp_path / "data" / "pinned" / "sets.tle").write_text("cut short")
            server.answers["/sets.tle"] = answer
            assert cli.main(["task", "month.yaml", "-o", "wrong"]) == 1
            assert told in capsys.readouterr().err
    assert not Path("wrong").exists()


def test_a_recipe_without_a_source_needs_files(recipe, tmp_path):
    told = refusal(recipes.make, recipe, [], task_folders.Folders(tmp_path / "task", tmp_path / "truth"))
    assert told == "sample: expected files to make it from, as its recipe has no source"


def test_sigmas_of_the_truth_are_added(sgp4, task):
    given, exact = answers.read(sgp4, task), tasks.read_truth(task, None)
    table, wide = (errors(task, given, one) for one in (exact, exact.assign(sigma_r=3.0, sigma_s=40.0)))
    for name, sigma in zip(tasks.SIGMAS, (3.0, 40.0, 0.0), strict=True):
        np.testing.assert_allclose(wide[name], np.hypot(table[name], sigma))


# Months whose truth comes later


def test_a_hidden_month_is_asked_answered_and_scored(sgp4, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    sinking_histories.write(tmp_path / "all.tle", range(101, 133), 63)
    text = (REPOSITORY / "benchmark" / "sample.yaml").read_text()
    (tmp_path / "month.yaml").write_text(text.replace("name: sample", "name: month").replace(
        "first: 2025-12-30\nlast: 2026-01-13", "first: 2026-01-06\nlast: 2026-01-06"
    ))  # fmt: skip
    lines = (tmp_path / "all.tle").read_text().splitlines()
    pairs = [lines[k : k + 2] for k in range(0, len(lines), 2)]
    known = [pair for pair in pairs if pair[0][18:32] < "26006.25"]
    assert 0 < len(known) < len(pairs)
    (tmp_path / "known.tle").write_text("\n".join(line for pair in known for line in pair) + "\n")
    assert cli.main(["task", "month.yaml", "known.tle", "-o", "month"]) == 0
    assert "month-truth is made by `opml truth` when it is over" in capsys.readouterr().out
    assert json.loads((tmp_path / "month" / "task.json").read_text())["truth_sha256"] == "hidden"
    assert cli.main(["answer", "month", "sgp4", "-o", "mine.csv"]) == 0
    assert cli.main(["score", "month", "mine.csv"]) == 1
    assert "expected the truth of month, got none" in capsys.readouterr().err
    assert cli.main(["truth", "month", "known.tle"]) == 1
    assert "month: expected sets within half a day of the questions, got none" in capsys.readouterr().err
    assert cli.main(["truth", "month", "all.tle"]) == 0
    asked = len(tasks.read("month").questions)
    assert f"month-truth: the truth of {asked} questions" in capsys.readouterr().out
    frozen = tasks.digest(tmp_path / "month-truth" / "truth.csv")
    assert cli.main(["truth", "month", "all.tle"]) == 1
    assert f"expected no truth yet, got that of SHA-256 {frozen}" in capsys.readouterr().err
    assert cli.main(["truth", "SAMPLE", "all.tle"]) == 1
    assert "sample: expected a hidden task, got one whose truth is frozen" in capsys.readouterr().err
    assert cli.main(["score", "month", "mine.csv", "-o", "mine.json"]) == 0
    rows = json.loads((tmp_path / "mine.json").read_text())["scores"]
    judged = benchmark.score(tasks.SAMPLE, sgp4).scores
    for row, same in zip(rows, judged.to_dict("records"), strict=True):
        assert 0.2 < row["along_track_median"] / same["along_track_median"] < 5.0
    # A question without a later set counts for nothing.
    truth = (tmp_path / "month-truth" / "truth.csv").read_text().splitlines()
    (tmp_path / "month-truth" / "truth.csv").write_text("\n".join(truth[:-1]) + "\n")
    asked = benchmark.score("month", "mine.csv").scores["questions"]
    assert asked.sum() == len(truth) - 2


# Storms


def test_storms_of_the_week_after_are_told_apart(sgp4, tmp_path):
    truth = tmp_path / "truth"
    shutil.copytree(SAMPLE.parent / "sample-truth", truth)
    weeks = pd.read_csv(truth / "weeks.csv", dtype={"t": str})
    assert weeks["t"].tolist() == sorted(set(tasks.read(tasks.SAMPLE).questions["t"]))
    weeks["highest_ap"] = [29, 30, np.nan]
    weeks.to_csv(truth / "weeks.csv", index=False)
    score = benchmark.score(tasks.SAMPLE, sgp4, truth)
    assert score.by_weather.groupby("weeks")["answers"].sum().to_dict() == {
        "other": 24,
        "quiet": 4,
        "stormy": 20,
    }
    assert "stormy weeks, 7 d: median " in benchmark.text(score)
    row = score.by_weather.set_index(["weeks", "lead"]).loc["stormy", 7]
    benchmark.write(tmp_path / "score.html", score)
    assert "stormy" in (tmp_path / "score.html").read_text()
    (truth / "weeks.csv").unlink()
    bare = benchmark.score(tasks.SAMPLE, sgp4, truth)
    assert bare.by_weather.empty
    assert "weeks" not in benchmark.text(bare)
    pd.testing.assert_frame_equal(bare.scores, score.scores)
    assert row["median"] > 0.0


def test_the_highest_ap_is_that_of_the_week_after(tmp_path):
    weather = Weather(60000, np.full(20, 100.0), np.tile([2.0] * 8, 20))
    weather.kp[8 * 12 : 8 * 13] = 5.0  # 2023-03-09: ap 48
    folder = tmp_path / "truth"
    folder.mkdir()
    asked = [(1, f"2023-03-{day:02d}T06:00:00", 1, "") for day in (1, 2, 9, 10)]
    truth = pd.DataFrame(np.zeros((len(asked), 6)), columns=[*tasks.STATE])
    task_folders.write_truth(folder, asked, truth, weather)
    found = pd.read_csv(folder / "weeks.csv")["highest_ap"]
    np.testing.assert_array_equal(found, [7.0, 48.0, 48.0, np.nan])  # the last week is not over


@pytest.mark.parametrize(("old", "new", "told"), refusals("recipes"))
def test_recipes_that_cannot_be_are_refused(old, new, told, tmp_path):
    text = (REPOSITORY / "benchmark" / "sample.yaml").read_text()
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=told):
        recipes.read(wrong)
