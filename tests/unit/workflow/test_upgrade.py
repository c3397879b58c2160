"""A project of an earlier version gets the workflow and settings of this one, and keeps what is its own."""

import shutil

import pytest

from opml import cli
from opml.base.files import PROJECT
from opml.workflow import new_project


@pytest.fixture
def project(tmp_path):
    """A project whose workflow and settings are of another version, with a sheet and results of its own."""
    folder = tmp_path / "mine"
    new_project.write(folder)
    (folder / "workflow" / "rules" / "day.smk").unlink()
    (folder / "config" / "config.yaml").write_text("pools: {}\n")
    (folder / "config" / "rsos.tsv").write_text("name\nmine\n")
    (folder / "results").mkdir()
    return folder


def test_an_upgrade_replaces_all_but_what_is_the_users(project, capsys):
    assert cli.main(["init", str(project), "--upgrade"]) == 0
    assert "what it replaced is in *.before" in capsys.readouterr().out
    for name in ("workflow/rules/day.smk", "config/config.yaml", "Snakefile"):
        assert (project / name).read_bytes() == (PROJECT / name).read_bytes()
    assert (project / "config" / "rsos.tsv").read_text() == "name\nmine\n"
    assert (project / "config.before" / "config.yaml").read_text() == "pools: {}\n"
    assert (project / "mine.yaml").read_text() == new_project.SIMULATED
    assert (project / "results").is_dir()
    assert list(project.glob(".new.*")) == []


def test_nothing_is_replaced_twice_or_where_no_project_is(project, capsys):
    shutil.copytree(project / "config", project / "config.before")
    assert cli.main(["init", str(project), "--upgrade"]) == 1
    assert "config.before: expected none: remove what an earlier upgrade replaced" in capsys.readouterr().err
    assert not (project / "Snakefile.before").exists()
    assert cli.main(["init", str(project.parent), "--upgrade"]) == 1
    assert "expected a project of `opml init`, got none" in capsys.readouterr().err
