"""A cache that cannot be written, and blanks in the path of Python."""

import os
import sys

import pytest

from opml.workflow.surroundings import lend_cache, name_python


@pytest.fixture
def home(tmp_path, monkeypatch):
    """The place of the user's cache, where nothing stands yet."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home" / "cache"))
    return tmp_path / "home"


def test_a_cache_that_can_be_written_is_used(home):
    lend_cache()
    assert os.environ["XDG_CACHE_HOME"] == str(home / "cache")
    assert list((home / "cache").iterdir()) == []


def test_without_one_there_is_another_in_the_folder_of_the_run(home):
    home.touch()  # no folder
    lend_cache()
    assert os.environ["XDG_CACHE_HOME"] == str(home.parent / ".snakemake" / "cache")


@pytest.mark.parametrize(
    ("path", "executable", "first"),
    [
        ("/my files/bin/python3", "python3", "/my files/bin"),
        ("/files/bin/python3", "/files/bin/python3", "/bin"),
    ],
)
def test_python_goes_by_its_name_where_its_path_has_blanks(monkeypatch, path, executable, first):
    monkeypatch.setenv("PATH", "/bin")
    monkeypatch.setattr(sys, "executable", path)
    name_python()
    assert sys.executable == executable
    assert os.environ["PATH"].split(os.pathsep)[0] == first
