"""Beyond the paper, on the trimmed case: models against splits, a harder truth."""

import re
import shutil

import numpy as np
import pytest
from project import ROOT, Project

from opml.tables import read_metadata, read_table

pytestmark = pytest.mark.dag
CI = "--configfile=config/ci.yaml"


@pytest.fixture(scope="module")
def beyond(finished, tmp_path_factory):
    """The finished run, carried on beyond the paper."""
    folder = tmp_path_factory.mktemp("beyond")
    shutil.copytree(finished.folder, folder, dirs_exist_ok=True)
    project = Project(folder, source=ROOT)
    project.snakemake("-j2", CI, "beyond")
    return project


def results(project, name):
    return project.folder / "results" / "ci" / name


def test_every_model_is_in_the_table(beyond):
    text = results(beyond, "beyond.md").read_text()
    for model in ("none", "boosting", "svr", "covariance", "mechanism"):
        assert len(re.findall(rf"^\| `{model}` \| [\d.]+ \([\d.]+ to [\d.]+\)", text, re.MULTILINE)) == 1
    assert re.search(r"^\| `none` \| 100\.0 \(100\.0 to 100\.0\)", text, re.MULTILINE)
    assert not re.search(r"\bnan\b", text)


def test_its_figure_is_drawn(beyond):
    assert results(beyond, "figs/beyond.pdf").stat().st_size > 5000
    assert results(beyond, "figs/beyond.png").stat().st_size > 5000


def test_without_a_truth_labels_are_learned_from_and_the_truth_judges(beyond):
    names = {
        label: f"metrics/iss/eglin-clear-kaena{label}/days-0-2/boosting/e_y/iss/days-2-3.parquet"
        for label in ("", "_later")
    }
    beyond.snakemake("-j2", CI, *(f"results/ci/{name}" for name in names.values()))
    found = {label: read_table(results(beyond, name), "metrics").iloc[0] for label, name in names.items()}
    assert len({one["rows"] for one in found.values()}) == 1
    assert [label for label, one in found.items() if np.isnan(one["p_ml_later"])] == [""]
    for label in ("_later",):
        assert found[label]["stations"] == f"eglin-clear-kaena{label}"
        assert found[label]["p_ml_later"] == pytest.approx(found[label]["p_ml"], rel=0.1)
    assert found["_later"]["p_ml"] == pytest.approx(found[""]["p_ml"], rel=0.3)


def test_a_model_tells_what_it_was_made_with(beyond):
    path = results(beyond, "models/iss/eglin-clear-kaena/days-0-2/mechanism/e_y.parquet")
    assert read_metadata(path)["kind"] == "linear_law"


def test_the_paper_is_not_run_again_for_it(beyond):
    assert "Nothing to be done" in beyond.snakemake("-n", CI).stdout


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
