"""The command `opml`: what it writes, and when it refuses to."""

import csv
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
import sinking_histories
from support import REPOSITORY, refusals

from opml import __main__ as started, __version__, cli
from opml.study.settings import editor_schema
from opml.tables import write_table
from opml.workflow import manual


def test_a_new_project_holds_the_workflow_and_the_study_of_the_howto(tmp_path, capsys):
    new = tmp_path / "my new"
    assert cli.main(["init", str(new)]) == 0
    for name in (
        "Snakefile",
        "workflow/rules/truth.smk",
        "config/stations.tsv",
        "profiles/default/config.yaml",
    ):
        assert (new / name).read_bytes() == (REPOSITORY / name).read_bytes()
    assert not any(path.is_symlink() for path in new.rglob("*"))
    assert "duration_days" in json.loads((new / editor_schema.PLACE).read_text())["properties"]
    page = (REPOSITORY / "docs" / "howto.md").read_text(encoding="utf-8")
    study = (new / "mine.yaml").read_text(encoding="utf-8")
    assert f"```yaml\n{study}```\n" in page
    *_, enter, study, pages = capsys.readouterr().out.splitlines()
    assert enter == f"cd '{new}'"
    assert (study, pages) == ("snakemake -j2 study --configfile mine.yaml", "opml docs howto")


@pytest.mark.parametrize("name", ["config", "Snakefile", "mine.yaml"])
def test_a_folder_with_such_files_is_refused_in_one_line(tmp_path, capsys, name):
    (tmp_path / name).mkdir()
    assert cli.main(["init", str(tmp_path)]) == 1
    error = capsys.readouterr().err
    assert error == f"opml: {tmp_path / name}: expected a folder without a project, got one that has this\n"
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_file_in_the_way_is_told_in_one_line(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert cli.main(["init", str(tmp_path / "file")]) == 1
    assert re.fullmatch(r"opml: .*file.*\n", capsys.readouterr().err)


def test_the_help_names_every_command_and_stands_where_none_is_given(capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(["--help"])
    assert ended.value.code == 0
    told = capsys.readouterr().out
    assert cli.main([]) == 0
    assert capsys.readouterr().out == told
    lines = told.splitlines()
    for command in cli.COMMANDS:
        assert any(line.split() == [command.name, *command.help.split()] for line in lines)
    first, _, last = told.partition("a project:")
    assert "  predict " in first
    assert "  table " in last


def test_a_terminal_without_the_letters_of_a_name_shows_others(table, monkeypatch):
    path = table[0].with_name("müll.parquet")
    table[0].rename(path)
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, "ascii"))
    assert cli.main(["table", str(path)]) == 0
    assert b"m\\xfcll.parquet: cd_past" in written.getvalue()


def test_every_page_of_the_documentation_is_listed_and_printed(capsys):
    assert cli.main(["docs"]) == 0
    listed = dict(re.findall(r"^  ([\w/]+) +(.+)$", capsys.readouterr().out, re.MULTILINE))
    tables = {f"data/{page.stem}" for page in (REPOSITORY / "docs" / "data").glob("*.md")}
    assert set(listed) == tables | {page.stem for page in (REPOSITORY / "docs").glob("*.md")} - {"index"}
    assert (listed["glossary"], listed["settings"]) == ("Glossary", "Settings")
    for page, title in listed.items():
        assert cli.main(["docs", page]) == 0
        text = capsys.readouterr().out
        assert f"# {title}\n" in text
        assert "{include}" not in text
    assert text == (REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("module", ["opml.cli", "erfa"])
def test_an_interrupt_is_told_in_one_line_in_the_midst_of_imports(module):
    """Compiled code whose import is broken off prints a traceback, whatever Python makes of its error."""
    code = f"""
import signal, sys
class Finder:
    def find_spec(name, path, target=None):
        if name == {module!r}:
            try:
                signal.raise_signal(signal.SIGINT)
            except KeyboardInterrupt:
                raise ImportError
sys.meta_path.insert(0, Finder)
from opml.__main__ import main
sys.argv = ["opml", "predict", "no.tle"]
sys.exit(main())
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "opml: interrupted; what is written is whole\n")


def test_an_interrupt_of_a_command_is_told_in_one_line(monkeypatch, capsys):
    monkeypatch.setattr(manual, "page", lambda name: signal.raise_signal(signal.SIGINT))
    monkeypatch.setattr(sys, "argv", ["opml", "docs", "tracks"])
    before = signal.getsignal(signal.SIGINT)
    try:
        assert started.main() == started.INTERRUPTED
    finally:
        signal.signal(signal.SIGINT, before)
    assert capsys.readouterr() == ("", "opml: interrupted; what is written is whole\n")


def test_a_warning_is_told_once():
    script = """
import logging
from opml import cli
cli.main(["docs"])
for word in ("twice", "twice", "once"):
    logging.getLogger("opml").warning("%s", word)
"""
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stderr == "opml: twice\nopml: once\n"


def test_a_page_that_is_not_there_is_told_in_one_line(capsys):
    for name, near in (("track", "tracks"), ("Kp", "weather or physics")):
        assert cli.main(["docs", name]) == 1
        assert capsys.readouterr().err == f"opml: docs: expected a page such as {near}, got {name}\n"


def test_the_page_of_a_command_is_told_by_its_name(capsys):
    assert cli.main(["docs", "predict"]) == 1
    assert capsys.readouterr().err == "opml: docs: expected a page such as improve or elements, got predict\n"


@pytest.fixture
def table(tmp_path):
    """A file of a table, and the table."""
    frame = pd.DataFrame({"i": range(9), "j": 7, "cd_past": 1.0 / np.arange(1.0, 10.0)})
    write_table(tmp_path / "past.parquet", frame, "cd_past", metadata={"seed": 42})
    return tmp_path / "past.parquet", frame


def test_a_table_is_printed_with_units_and_metadata(table, capsys):
    assert cli.main(["table", str(table[0])]) == 0
    first, seed, _, names, *columns = capsys.readouterr().out.splitlines()
    assert (first, seed) == (f"{table[0]}: cd_past, 9 rows", "seed: 42")
    assert names.split() == ["column", "unit", "row", "0", "row", "1", "row", "2", "meaning"]
    assert columns[2].split()[:6] == ["cd_past", "1", "1", "0.5", "0.333333", "mean"]
    assert len(columns) == table[1].shape[1]


def test_a_table_comes_back_from_csv_to_the_last_bit(table, capsys):
    assert cli.main(["table", str(table[0]), "--csv"]) == 0
    names, *rows = csv.reader(capsys.readouterr().out.splitlines())
    assert names == list(table[1].columns)
    assert [list(map(float, row)) for row in rows] == table[1].to_numpy().tolist()


@pytest.mark.parametrize("arguments", [[], ["--csv"]])
def test_a_damaged_or_missing_table_is_told_in_one_line(table, capsys, arguments):
    path, _ = table
    assert cli.main(["table", f"{path}.none", *arguments]) == 1
    assert capsys.readouterr() == ("", f"opml: {path}.none: no such file\n")
    path.write_bytes(path.read_bytes()[:-20])
    assert cli.main(["table", str(path), *arguments]) == 1
    output, error = capsys.readouterr()
    assert output == ""
    assert re.fullmatch(rf"opml: {path}: damaged.*\n", error)
    table[1].to_parquet(path)
    assert cli.main(["table", str(path), *arguments]) == 1
    assert "not written by opml" in capsys.readouterr().err


def test_a_reader_that_has_enough_ends_the_command_quietly(table, monkeypatch, capfd):
    reading, writing = os.pipe()
    os.close(reading)
    with open(writing, "w") as output:
        monkeypatch.setattr(sys, "stdout", output)
        assert cli.main(["table", str(table[0]), "--csv"]) == 0
    assert capfd.readouterr().err == ""


def test_one_version_everywhere():
    script = (REPOSITORY / "workflow" / "envs" / "opml.post-deploy.sh").read_text(encoding="utf-8")
    citation = (REPOSITORY / "CITATION.cff").read_text(encoding="utf-8")
    assert re.findall(r"opml-orbits==(\S+)", script) == [__version__]
    assert re.findall(r"^version: (\S+)$", citation, re.MULTILINE) == [__version__]
    assert re.search(
        rf"^## {re.escape(__version__)}", (REPOSITORY / "CHANGELOG.md").read_text(), re.MULTILINE
    )


@pytest.mark.parametrize("folder", ["", " "])
def test_a_project_without_a_folder_is_refused(tmp_path, monkeypatch, capsys, folder):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["init", folder]) == 1
    assert capsys.readouterr().err == f"opml: init: expected a folder, got {folder!r}; . is this one\n"
    assert list(tmp_path.iterdir()) == []


POINTS = """\
utc,x_gcrf_m,y_gcrf_m,z_gcrf_m
2016-09-28T12:10:00,7000000.0,0.0,0.0
2016-09-28T12:11:00,6990000.0,450000.0,0.0
"""


@pytest.mark.parametrize(("arguments", "line"), refusals("commands"))
def test_what_cannot_be_is_refused_in_a_line_and_writes_nothing(
    arguments, line, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "points.csv").write_text(POINTS)
    shutil.copy(REPOSITORY / "tests" / "reference" / "orekit.tdm", tmp_path / "tracks.tdm")
    sinking_histories.write(tmp_path / "sets.tle", range(101, 102), 49)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert cli.main(arguments) == 1
    told = capsys.readouterr().err.splitlines()
    assert told[-1].startswith("opml: ")
    assert re.search(line, told[-1])
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
