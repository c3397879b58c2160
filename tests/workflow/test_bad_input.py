"""Bad input through the real command line: one clear line, exit code not 0, nothing made."""

import shutil

import pytest
from project import Project
from support import refusals

CHATTER = (
    *("Using workflow specific profile", "Config file config/config.yaml is extended"),
    *("Assuming unrestricted shared filesystem", "Building DAG of jobs"),
)
CONFIG = "config/config.yaml"


def refused(project, *arguments):
    """The one line with which a dry run is refused."""
    done = project.snakemake("-n", *arguments, check=False)
    lines = [line for line in done.stdout.splitlines() if line and not line.startswith(CHATTER)]
    assert done.returncode != 0, done.stdout
    assert len(lines) == 1, done.stdout
    assert lines[0].startswith("opml: ")
    assert not (project.folder / "results").exists()
    return lines[0].removeprefix("opml: ")


@pytest.mark.parametrize(("edit", "arguments", "line"), refusals("command_line"))
def test_what_is_wrong_is_told_in_one_line(project, edit, arguments, line):
    if edit:
        name, old, new = edit
        path = project.folder / name
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))
    assert refused(project, *arguments) == line


def test_a_folder_without_a_project(project):
    (project.folder / "elsewhere").mkdir()
    away = Project(project.folder / "elsewhere")
    shutil.rmtree(away.folder / "config")
    assert refused(away) == (
        f"{CONFIG}: no such file in {away.folder}; --directory names the folder of another project"
    )
