"""Models against splits, on the trimmed case; a harder truth."""

import re
import shutil

import numpy as np
import pytest
from project import ROOT, Project

from opml.tables import read_metadata, read_table

pytestmark = pytest.mark.dag
CI = "--configfile=config/ci.yaml"


@pytest.fixture(scope="module")
def study(finished, tmp_path_factory):
    """The finished run, carried on to its models against splits."""
    folder = tmp_path_factory.mktemp("study")
    shutil.copytree(finished.folder, folder, dirs_exist_ok=True)
    project = Project(folder, source=ROOT)
    project.snakemake("-j2", CI, "study")
    return project


def results(project, name):
    return project.folder / "results" / "ci" / name


def test_every_model_is_in_the_table(study):
    text = results(study, "study.md").read_text()
    for model in ("none", "boosting", "svr", "covariance", "mechanism"):
        row = rf"^\| iss \| eglin-clear-kaena \| `{model}` \| [\d.]+ \([\d.]+ to [\d.]+\)"
        assert len(re.findall(row, text, re.MULTILINE)) == 1
    assert re.search(r"\| `none` \| 100\.0 \(100\.0 to 100\.0\)", text)
    assert not re.search(r"\bnan\b", text)


def test_its_figure_is_drawn(study):
    assert results(study, "figs/study/iss/models.pdf").stat().st_size > 5000
    assert results(study, "figs/study/iss/models.png").stat().st_size > 5000


def test_without_a_truth_labels_are_learned_from_and_the_truth_judges(study):
    names = {
        label: f"metrics/iss/eglin-clear-kaena{label}/days-0-2/boosting/e_y/iss/days-2-3.parquet"
        for label in ("", "_later")
    }
    study.snakemake("-j2", CI, *(f"results/ci/{name}" for name in names.values()))
    found = {label: read_table(results(study, name), "metrics").iloc[0] for label, name in names.items()}
    assert len({one["rows"] for one in found.values()}) == 1
    assert [label for label, one in found.items() if np.isnan(one["p_ml_later"])] == [""]
    for label in ("_later",):
        assert found[label]["stations"] == f"eglin-clear-kaena{label}"
        assert found[label]["p_ml_later"] == pytest.approx(found[label]["p_ml"], rel=0.1)
    assert found["_later"]["p_ml"] == pytest.approx(found[""]["p_ml"], rel=0.3)


def test_a_model_tells_what_it_was_made_with(study):
    path = results(study, "models/iss/eglin-clear-kaena/days-0-2/mechanism/e_y.parquet")
    assert read_metadata(path)["kind"] == "linear_law"


def test_the_paper_is_not_run_again_for_it(study):
    assert "Nothing to be done" in study.snakemake("-n", CI).stdout


def test_a_harder_truth_changes_the_truth_and_not_the_assumed_model(project):
    plan = project.snakemake(
        "-n", "--configfile", "config/observed.yaml", "--", "results/observed/truth/iss.parquet"
    )
    assert "Solar activity: OBSERVED" in plan.stdout
    assert "Solar activity: MSAFE" not in plan.stdout
    plan = project.snakemake(
        "-n", "--configfile", "config/observed.yaml", "--", "results/observed/estimates/iss/eglin.parquet"
    )
    assert "Solar activity: MSAFE" in plan.stdout
