"""A study of a catalogue from the command line: its plan, what it refuses, and a small one that runs."""

import catalogue_files
import pytest
from project import jobs

from opml.tables import read_table

SETTINGS = """
results: results/few
catalogue:
  populations: {payloads: {files: "*.tle"%s}}
  weather: weather.csv
  learners: [%s]
  tests:
    winter: {population: %s, train: ["2016-01-15", %s], test: ["2016-03-08", "2016-03-15"]}
study: {}
"""
LAST = '"2016-02-25"'


def asked(project, *, learners="trees", population="payloads", last=LAST, orbits=""):
    """Write the settings of a small study; returns the option that names them."""
    (project.folder / "few.yaml").write_text(SETTINGS % (orbits, learners, population, last))
    return "--configfile=few.yaml"


@pytest.fixture
def few(project):
    """A project with 36 objects and weather of two years."""
    catalogue_files.write_sets(project.folder / "sets.tle", objects=36, days=90)
    begin = catalogue_files.FIRST_DAY
    catalogue_files.write_weather(project.folder / "weather.csv", first=begin - 600, last=begin + 90)
    return project


def test_plan_of_a_catalogue(few):
    plan = jobs(few.snakemake("-n", "catalogue", asked(few, learners="trees, svr")).stdout)
    once = ["densities", "rows", "scores", "report", "shares", "seasons"]
    assert plan == {"catalogue": 1, "catalogue_residuals": 2, **{f"catalogue_{name}": 1 for name in once}}


def test_what_is_wrong_with_a_catalogue_is_told_in_one_line(few):
    where = "opml: few.yaml: catalogue.tests.winter"
    for wrong, told in (
        ({"population": "debris"}, f"{where}.population: expected one of payloads, got 'debris'\n"),
        (
            {"population": "payloads, taught_by: debris"},
            f"{where}.taught_by: expected one of payloads, got 'debris'\n",
        ),
        (
            {"orbits": ", orbits: a.parquet"},
            "catalogue.populations.payloads.orbits: a.parquet: no such file; ",
        ),
        ({"last": '"2016-03-08"'}, f"{where}: expected dates to train on before those to test on, or "),
        ({"last": '"2016-02-30"'}, f"{where}: "),
        ({"last": "5"}, f'{where}.train.1: expected a date (UTC) in quotes, like "2026-03-15", got 5\n'),
    ):
        done = few.snakemake("-n", "catalogue", asked(few, **wrong), check=False)
        assert done.returncode != 0
        assert told in done.stdout
    assert "Traceback" not in done.stdout


@pytest.mark.dag
def test_a_small_catalogue_runs(few):
    few.snakemake("-j2", "catalogue", asked(few))
    results = few.folder / "results" / "few"
    scores = read_table(results / "catalogue" / "scores.parquet", "catalogue_scores")
    assert scores["lead"].tolist() == [1, 3, 5, 7] * 2
    assert set(scores["learner"]) == {"trees"}
    assert (scores["objects"] > 10).all()
    for name in (
        "catalogue/catalogue.md",
        "catalogue/catalogue.html",
        "figs/catalogue/winter.pdf",
        "figs/catalogue_seasons.pdf",
    ):
        assert (results / name).stat().st_size > 1000
