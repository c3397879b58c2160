"""The benchmark's tasks of tracks: what their inputs hold, and what the baselines make of them."""

import csv
import runpy
import subprocess
import sys

import numpy as np
import pytest
from support import REPOSITORY, refusal, refusals, shared

from opml.benchmark import recipes, tasks
from opml.benchmark.task_folders import Folders
from opml.interop import tdm
from opml.report import benchmark

SAMPLE = REPOSITORY / "src" / "opml" / "data" / "benchmark" / "sample-tracks"
NAME = "SAMPLE-TRACKS"


@pytest.fixture(scope="module")
def task():
    return tasks.read(NAME)


def answered(folder, *ways):
    """Run the script of baselines; the paths of its answers, by way."""
    script = REPOSITORY / "benchmark" / "track_fits.py"
    before, sys.argv = sys.argv, [str(script), NAME, str(folder), *ways]
    try:
        runpy.run_path(str(script), run_name="__main__")
    finally:
        sys.argv = before
    return {way: folder / f"sample-tracks_{way}.csv" for way in ways}


@pytest.fixture(scope="module")
def fits(tmp_path_factory):
    return answered(tmp_path_factory.mktemp("answers"), "last", "svr", "trees", "sgp4")


def test_inputs_hold_nothing_of_later(task):
    for (t, number), _ in task.questions.groupby(["t", "object"]):
        measured = tdm.measurements([task.inputs(t) / f"{number}.tdm"], epoch=t)["t"]
        assert -2.0 * 86400.0 <= measured.min() < measured.max() <= 0.0
        for name, days in (("weather.csv", "DATE"), ("earth_orientation.csv", "mjd")):
            last = list(csv.reader((task.inputs(t) / name).read_text().splitlines()))[-1][0]
            day = np.datetime64(last) if days == "DATE" else np.datetime64("1858-11-17") + int(last)
            assert day <= np.datetime64(t[:10])


@pytest.mark.slow
def test_the_tracks_are_what_their_recipe_makes(tmp_path):
    make = runpy.run_path(str(REPOSITORY / "tests" / "reference" / "benchmark_sample.py"))["make_tracks"]
    assert make(tmp_path) == 12
    for path in SAMPLE.rglob("*.tdm"):
        ours, theirs = (
            tdm.measurements([one], epoch="2016-09-28T00:00:00")
            for one in (path, tmp_path / "sample-tracks" / path.relative_to(SAMPLE))
        )
        np.testing.assert_allclose(ours["range"], theirs["range"], rtol=0.0, atol=0.11)


@pytest.mark.slow
def test_baselines_answer_with_sigmas(fits):
    medians = {}
    for way, path in fits.items():
        score = benchmark.score(NAME, path)
        assert score.suspicions == []
        row = score.scores.set_index("lead")
        assert row["answered"].tolist() == [100.0] * 4
        assert np.isfinite(row[["along_track_crps", "along_track_log_score"]]).all(axis=None)
        medians[way] = row["along_track_median"]
    assert (medians["last"] < 100e3).all()
    assert not np.allclose(medians["last"], medians["svr"])


@pytest.mark.slow
def test_orekit_answers_all_that_is_asked(tmp_path):
    pytest.importorskip("orekit_jpype", reason="needs the extra `verify`")
    data = shared("orekit-data")
    command = [sys.executable, "-m", "benchmark.orekit_fits", NAME, str(tmp_path), str(data)]
    subprocess.run(command, cwd=REPOSITORY, check=True)
    score = benchmark.score(NAME, tmp_path / "sample-tracks_orekit.csv")
    assert score.suspicions == []
    assert score.scores["answered"].tolist() == [100.0] * 4
    assert (score.scores["along_track_median"] < 100e3).all()


def test_what_no_file_answers_is_refused(tmp_path):
    recipe = recipes.read(REPOSITORY / "benchmark" / "sample-tracks.yaml")
    folders = Folders(tmp_path / "task", tmp_path / "truth")
    told = refusal(recipes.make, recipe, [tmp_path / "other.oem"], folders)
    assert "sample-tracks: 1: expected files as iss.oem, got none" in told
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("old", "new", "told"), refusals("recipes_of_tracks"))
def test_misspelt_recipes_are_refused(old, new, told, tmp_path):
    text = (REPOSITORY / "benchmark" / "sample-tracks.yaml").read_text()
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(text.replace(old, new, 1))
    assert told in refusal(recipes.read, wrong)
