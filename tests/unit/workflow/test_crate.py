"""A finished run as an RO-Crate: what it tells of the run, by the profile Workflow Run Crate."""

import hashlib
import json
import shutil
import zipfile
from importlib.metadata import version

import pytest
from support import REPOSITORY

pytest.importorskip("rocrate", reason="rocrate is not installed: the extra crate")

from rocrate.rocrate import ROCrate

from opml import __version__, cli

REPORT = b"# The study\n"


@pytest.fixture
def archive(tmp_path, monkeypatch):
    """The crate of a run that left a report, a log and a file that is not finished."""
    shutil.copytree(REPOSITORY / "config", tmp_path / "config")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text("results: results/mine\nduration_days: 12\nstudy: {rsos: [iss]}\n")
    folder = tmp_path / "results" / "mine"
    folder.mkdir(parents=True)
    (folder / "study.md").write_bytes(REPORT)
    (folder / ".study.tsv.1.tmp").write_bytes(b"")
    assert cli.main(["pack", "--configfile", "mine.yaml"]) == 0
    return tmp_path / "results" / "mine.crate.zip"


@pytest.fixture
def entities(archive):
    """The entities of its metadata by their identifiers."""
    with zipfile.ZipFile(archive) as opened:
        graph = json.loads(opened.read("ro-crate-metadata.json"))["@graph"]
    return {entity["@id"]: entity for entity in graph}


def ids(value):
    """The identifiers that a property refers to."""
    return [one["@id"] for one in (value if isinstance(value, list) else [value])]


def test_the_run_tells_what_made_what_of_what(entities):
    root = entities["./"]
    assert "https://w3id.org/ro/wfrun/workflow/0.5" in ids(root["conformsTo"])
    (run,) = (entities[one] for one in ids(root["mentions"]))
    assert run["@type"] == "CreateAction"
    assert ids(run["instrument"]) == ids(root["mainEntity"]) == ["workflow/Snakefile"]
    assert ids(run["result"]) == ["study.md"]
    assert {"settings.yaml", "inputs/mine.yaml", "inputs/config/rsos.tsv"} <= set(ids(run["object"]))
    assert run["startTime"] <= run["endTime"]
    assert ids(entities["settings.yaml"]["exampleOfWork"]) == ids(entities["workflow/Snakefile"]["input"])


def test_files_have_digests_and_programs_have_versions(entities):
    assert entities["study.md"]["encodingFormat"] == "text/markdown"
    assert entities["study.md"]["sha256"] == hashlib.sha256(REPORT).hexdigest()
    programs = {
        entities[one]["name"]: entities[one]["version"]
        for one in ids(entities["workflow/Snakefile"]["softwareRequirements"])
    }
    assert programs["opml-orbits"] == __version__
    assert programs["numpy"] == version("numpy")
    assert "workflow/rules/truth.smk" in entities


def test_the_archive_holds_what_it_describes(archive, entities, tmp_path):
    with zipfile.ZipFile(archive) as opened:
        held = set(opened.namelist())
        assert b"duration_days: 12" in opened.read("settings.yaml")
    assert {one for one in entities if "File" in entities[one]["@type"]} <= held
    assert ROCrate(archive).mainEntity.id == "workflow/Snakefile"


def test_a_file_that_the_run_was_made_of_must_be_there(archive, capsys):
    given = ["pack", "--configfile", "mine.yaml", "--config", "orbits={iss: flown.oem}", "data=orbits"]
    assert cli.main(given) == 1
    error = capsys.readouterr().err
    assert error == "opml: orbits/flown.oem: expected a file that the run was made of, got none\n"


def test_a_run_without_results_is_told_in_one_line(tmp_path, monkeypatch, capsys):
    shutil.copytree(REPOSITORY / "config", tmp_path / "config")
    monkeypatch.chdir(tmp_path)
    assert cli.main(["pack"]) == 1
    assert capsys.readouterr().err == "opml: results: expected the results of a run, got none\n"
