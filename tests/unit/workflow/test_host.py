"""A cache that cannot be written, and blanks in the path of Python."""

import os
import sys

import pytest

from opml.workflow.host import lend_cache, name_python


@pytest.fixture
def places(tmp_path, monkeypatch):
    """The user's cache, the one beside the packages, and the one in the run's folder; none stands yet."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "venv"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home" / "cache"))
    return [tmp_path / "home" / "cache", tmp_path / "venv" / "cache", tmp_path / ".snakemake" / "cache"]


@pytest.mark.parametrize("taken", [0, 1, 2], ids=["own", "beside the packages", "of the run"])
def test_the_first_cache_that_can_be_written_is_used(places, taken):
    for place in places[:taken]:
        place.parent.touch()  # no folder
    lend_cache()
    assert os.environ["XDG_CACHE_HOME"] == str(places[taken])


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
