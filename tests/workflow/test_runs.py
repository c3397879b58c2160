"""The workflow itself, run on the trimmed case."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time

import pyarrow.parquet as pq
import pytest
from project import ROOT, Project, command

from opml.learning.models import learners
from opml.tables import SCHEMAS, read_metadata, read_table

pytestmark = pytest.mark.dag
CI = "--configfile=config/ci.yaml"
CURVE = "results/ci/figs/partition_curve.pdf"

ENVIRONMENT = ("earth_orientation", "ephemerides", "gravity_field", "solar_activity")
# What reads what: each rule needs one before it; what is drawn and tabulated needs the last of its row.
CHAIN = ("truths", "tracking", "estimation", "prediction", "dataset", "train", "evaluate")
READERS = {
    "truths": {"orbit"},
    "tracking": {"estimation_window", "orbit"},
    "dataset": {"error_distribution"},
    "evaluate": {
        "svr",
        "partition",
        "partition_curve",
        "individual",
        "rso_grid",
        "transfer_curve",
        "reproduction",
    },
}
# The module that draws errors states P_ML; it draws the dataset's errors too.
USES = {"learning/judge/metrics.py": {"error_distribution"}, "learning/data/cleaning.py": {"tables"}}
EVALUATIONS = (
    "svr_training_1station",
    "svr_testing_1station",
    "svr_testing_3stations",
    "future_5days",
    "future_10days",
    "future_15days",
    "inclination_50",
    "semi_major_axis_50",
)
FIGURES = (
    *("estimation_window", "orbit_3d", "orbital_elements"),
    *("error_distribution_position", "error_distribution_velocity"),
    *(f"{name}_{kind}" for name in EVALUATIONS for kind in ("absolute", "signed")),
    *("partition_50", "partition_curve"),
    *("individual_reduced", "individual_increased", "individual_distribution"),
    *("rso_grid", "inclination_curve", "semi_major_axis_curve"),
)
TABLES = ("models", "stations", "rso", "rsos")


@pytest.fixture
def copy(finished, tmp_path):
    """The finished folder with a workflow of its own, to be changed."""
    shutil.copytree(finished.folder, tmp_path, dirs_exist_ok=True)
    for name in ("workflow", "src", "profiles"):
        shutil.copytree(ROOT / name, tmp_path / name)
    shutil.copy2(ROOT / "Snakefile", tmp_path)
    return Project(tmp_path, source=tmp_path)


def reruns(project, *arguments):
    """Rules that would run."""
    plan = project.snakemake("-n", CI, *arguments).stdout
    if "Nothing to be done" in plan:
        return set()
    table = plan.split("Job stats:")[1].split("total")[0]
    return set(re.findall(r"^(\w+) +\d+$", table, re.MULTILINE)) - {"default"}


def from_rule(rule):
    """A rule and all that come after it."""
    if rule not in (*ENVIRONMENT, *CHAIN):
        return {rule}
    after = CHAIN if rule in ENVIRONMENT else CHAIN[CHAIN.index(rule) :]
    readers = set().union(*(READERS.get(one, set()) for one in after))
    return {rule, *after, *readers, *({"orbit"} if rule == "gravity_field" else set())}


def test_every_product_is_there(finished):
    stem = "iss/eglin-clear-kaena"
    split = f"{stem}/random-80/svr/e_y"
    assert {
        *(f"ci/environment/{name}.parquet" for name in ("earth_orientation", "ephemerides", "gravity_field")),
        "ci/truth/iss.parquet",
        "ci/truth_groups/iss.parquet",
        *(f"ci/{name}/{stem}.parquet" for name in ("tracking", "estimates", "predictions", "dataset")),
        f"ci/models/{split}.parquet",
        f"ci/evaluation/{split}/iss/rest.parquet",
        f"ci/metrics/{split}/iss/rest.parquet",
        f"ci/dataset/{stem}_track.parquet",
        "ci/estimates/iss/eglin_noise43.parquet",
        f"ci/metrics/{stem}/random-80_split43/svr/e_y/iss/rest.parquet",
        *(f"ci/figs/{name}.{kind}" for name in FIGURES for kind in ("pdf", "png")),
        *(
            f"ci/{name}.{kind}"
            for name in ("reproduction", *(f"tables/{name}" for name in TABLES))
            for kind in ("md", "tsv", "html")
        ),
    } <= finished.products().keys()


def test_reproduction_tells_every_headline(finished):
    text = (finished.folder / "results" / "ci" / "reproduction.md").read_text()
    for number in ("18.3", "22.6", "9.6", "35.5", "40.2", "86.0"):
        assert f"| {number} |" in text
    assert not re.search(r"\bnan\b", text)


def test_report_is_one_file_with_every_figure(copy):
    copy.snakemake(CI, "--report", "report.html")
    page = (copy.folder / "report.html").read_text()
    for name in FIGURES:
        assert f"results/ci/figs/{name}.png" in page
    assert "0 The paper" in page
    assert "<script src=" not in page
    assert "<link" not in page


def test_every_table_tells_how_it_was_made(finished):
    for path in finished.folder.glob("results/ci/**/*.parquet"):
        kind = path.relative_to(finished.folder / "results" / "ci").parts[0]
        metadata = read_metadata(path)
        assert {"epoch", "time_scale", "settings", "version"} <= metadata.keys()
        schema = SCHEMAS.get(path.stem if kind == "environment" else kind)
        if kind == "models":
            schema = learners.schema(metadata)
        assert list(read_table(path, schema).columns) == schema.names


def test_every_job_has_log_and_benchmark(finished):
    results = finished.folder / "results" / "ci"
    logs = {path.relative_to(results / "logs").with_suffix("") for path in results.glob("logs/**/*.log")}
    marks = {
        path.relative_to(results / "benchmarks").with_suffix("")
        for path in results.glob("benchmarks/**/*.tsv")
    }
    assert logs == marks
    assert len(logs) > 130
    assert all("finished" in path.read_text() for path in results.glob("logs/**/*.log"))


def test_nothing_is_left_to_do(copy):
    assert reruns(copy) == set()


def test_one_core_gives_the_same_bytes(finished, project):
    project.snakemake("-j1", CI, CURVE)
    assert project.products().items() <= finished.products().items()


def test_a_truth_made_alone_has_the_bytes_of_one_made_among_others(project):
    path, made = "results/ci/truth/iss.parquet", []
    for rule in ("truths", "truth"):
        project.snakemake("-j1", CI, "--allowed-rules", *ENVIRONMENT, rule, "--", path)
        made.append(project.products())
        (project.folder / path).unlink()
    assert made[0] == made[1]


@pytest.mark.parametrize(
    ("module", "rule"),
    [
        ("environment/gravity_field.py", "gravity_field"),
        ("environment/solar_activity.py", "solar_activity"),
        ("data/msafe.tsv", "solar_activity"),
        ("dynamics/kernels/drag.py", "truths"),
        ("catalog/predict/prediction.py", "prediction"),
        ("learning/data/cleaning.py", "dataset"),
        ("learning/judge/metrics.py", "evaluate"),
        ("report/reproduction.py", "reproduction"),
    ],
)
def test_changed_module_reruns_what_uses_it_and_what_follows(copy, module, rule):
    path = copy.folder / "src" / "opml" / module
    path.write_text(path.read_text() + "\n# changed\n")
    assert reruns(copy) == from_rule(rule) | USES.get(module, set())


def test_module_that_no_rule_uses_reruns_nothing(copy):
    path = copy.folder / "src" / "opml" / "study" / "checks.py"
    path.write_text(path.read_text() + "\n# changed\n")
    assert reruns(copy) == set()


def test_changed_script_reruns_its_rule(copy):
    script = copy.folder / "workflow" / "scripts" / "dataset.py"
    script.write_text(script.read_text() + "\n# changed\n")
    assert reruns(copy) == from_rule("dataset")


@pytest.mark.parametrize(
    ("setting", "rule"),
    [
        ("prediction={max_days: 2}", "prediction"),
        ("study={cleaning: {fence: 2.5}}", "dataset"),
        ("learners={svr: {c: 2}}", "train"),
    ],
)
def test_changed_setting_reruns_what_depends_on_it(copy, setting, rule):
    assert reruns(copy, "--config", setting) == from_rule(rule)


def test_changed_force_model_reruns_its_table_too(copy):
    expected = from_rule("estimation") | {"tables", "reproduction"}
    assert reruns(copy, "--config", "force_models={assumed: {degree: 5}}") == expected


def test_a_table_without_a_column_is_made_anew(finished, copy):
    truth = copy.folder / "results" / "ci" / "truth" / "iss.parquet"
    pq.write_table(pq.read_table(truth).drop_columns(["vy"]), truth)
    copy.snakemake("-j1", CI, "results/ci/tracking/iss/clear.parquet")
    assert truth.read_bytes() == finished.products()["ci/truth/iss.parquet"]


def test_a_table_with_a_damaged_page_is_named_and_nothing_is_half_written(copy):
    truth, tracking = (
        copy.folder / "results" / "ci" / name for name in ("truth/iss.parquet", "tracking/iss")
    )
    content = bytearray(truth.read_bytes())
    content[len(content) // 2] ^= 1
    truth.write_bytes(content)
    before = sorted(path.name for path in tracking.iterdir())
    done = copy.snakemake("-j1", CI, "results/ci/tracking/iss/clear.parquet", check=False)
    assert done.returncode != 0
    assert "opml: results/ci/truth/iss.parquet: damaged (its pages do not match its seal)" in done.stdout
    assert "Traceback" not in done.stdout
    assert sorted(path.name for path in tracking.iterdir()) == before


def test_a_clock_set_back_stops_nothing(finished, copy):
    made = "results/ci/evaluation/iss/eglin/random-80/svr/e_y/iss/rest.parquet"
    tomorrow = time.time() + 86400.0
    for path in (copy.folder / "results").rglob("*.parquet"):
        os.utime(path, (tomorrow, tomorrow))
    (copy.folder / made).unlink()
    copy.snakemake("-j1", CI, made)
    assert copy.products() == finished.products()


def test_jobs_that_run_here_start_without_a_limit(project):
    told = project.snakemake("-j1", "--verbose", "results/environment/gravity_field.parquet").stdout
    counts = re.findall(r"Resources after job selection: .*'_job_count': (\d+)", told)
    assert set(map(int, counts)) == {sys.maxsize}


def test_killed_run_carries_on(finished, project):
    run = subprocess.Popen(
        command("-j2", CI, CURVE),
        cwd=project.folder,
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    time.sleep(6.0)  # `make faults` kills at many moments
    os.killpg(run.pid, signal.SIGKILL)
    run.wait()
    project.snakemake("-j2", CI, CURVE)
    products = {name: content for name, content in project.products().items() if not name.endswith(".tmp")}
    assert products.items() <= finished.products().items()
