"""A folder of results: whatever happens to it, no table of other settings is taken for one of these."""

import fcntl
import os
import re
import shutil

import pytest
from project import ROOT

from opml.tables import read_table

TABLE = "environment/gravity_field.parquet"
OTHER = "force_models={truth: {degree: 6, order: 6}, assumed: {degree: 4, order: 4}}"


def run(project, *arguments, folder="results", check=True):
    """Make the gravity field's table in a folder of results, or plan to."""
    settings = [f"results={folder}", *(one for one in arguments if "=" in one)]
    options = [one for one in arguments if "=" not in one]
    return project.snakemake(*options, "-j1", f"{folder}/{TABLE}", "--config", *settings, check=check)


@pytest.fixture
def made(project):
    """A project with the table, made under its settings."""
    run(project)
    return project


def highest(project, folder="results"):
    """The highest degree in the table."""
    return read_table(project.folder / folder / TABLE, "gravity_field")["n"].max()


def test_a_folder_that_was_moved_is_made_anew_under_other_settings(made):
    (made.folder / "results").rename(made.folder / "moved")
    assert "Nothing to be done" in run(made, "-n", folder="moved").stdout
    assert "params have changed" in run(made, "-n", OTHER, folder="moved").stdout
    assert highest(made, "moved") == 40
    run(made, OTHER, folder="moved")
    assert highest(made, "moved") == 6


def test_a_project_that_was_copied_without_records_is_made_anew_under_other_settings(made):
    shutil.rmtree(made.folder / ".snakemake")
    assert "Nothing to be done" in run(made, "-n").stdout
    run(made, OTHER)
    assert highest(made) == 6


def test_a_table_of_another_run_in_its_place_is_made_anew(made):
    run(made, OTHER, folder="other")
    shutil.copy2(made.folder / "other" / TABLE, made.folder / "results" / TABLE)
    run(made)
    assert highest(made) == 40


def test_an_input_that_was_revised_under_an_older_stamp_is_seen(project):
    """As `cp -p`, archives and downloads leave it."""
    mine = project.folder / "mine.gfc"
    text = (ROOT / "src" / "opml" / "data" / "egm2008_70.gfc").read_text()
    mine.write_text(text)
    source = "environment={gravity_field: mine.gfc}"
    run(project, source)
    os.utime(mine, (1.5e9, 1.5e9))
    assert "Nothing to be done" in run(project, "-n", source).stdout
    mine.write_text(text.replace("-0.000484165", "-0.000484166", 1))
    os.utime(mine, (1.5e9, 1.5e9))
    assert "params have changed" in run(project, "-n", source).stdout


def test_a_second_run_in_a_folder_is_told_who_holds_it(made):
    path = made.folder / "results" / "logs" / ".running"
    holder = path.read_text().strip()
    with path.open("a") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        done = run(made, OTHER, check=False)
    assert done.returncode != 0
    message = f"opml: results: expected no other run in this folder of results, but {holder} runs in it"
    assert message in done.stdout
    assert "Traceback" not in done.stdout
    run(made, OTHER)  # the lock ended with its holder
    assert highest(made) == 6


def test_plans_need_no_lock(made):
    with (made.folder / "results" / "logs" / ".running").open("a") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert "Nothing to be done" in run(made, "-n").stdout


@pytest.mark.parametrize("rules", [path.name for path in sorted((ROOT / "workflow" / "rules").glob("*.smk"))])
def test_the_content_of_every_file_of_the_users_counts(rules):
    """A rule that takes one has its digest among its params."""
    text = (ROOT / "workflow" / "rules" / rules).read_text()
    for rule in re.split(r"^ *rule ", text, flags=re.MULTILINE)[1:]:
        takes = "users(" in rule or "local(" in rule.replace("localrules", "")
        assert takes == ("contents(" in rule), rule.split(":")[0]
