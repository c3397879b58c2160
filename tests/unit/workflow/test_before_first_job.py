"""What ends a start in one line before anything is planned: files on the command line, and folders."""

import os

import pytest

from opml.workflow import before_first_job
from opml.workflow.command_line import check_settings


def ended(function, *arguments):
    """The one line with which a start ends."""
    with pytest.raises(SystemExit) as end:
        function(*arguments)
    return str(end.value)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


TARGET = "expected a file of settings after --configfile; targets are before it, or after --"


WRONG = {
    "no file": ("none.yaml", None, "no such file"),
    "target": ("study", None, TARGET),
    "file as target": ("results/figs/x.pdf", None, TARGET),
    "table": ("x.parquet", b"PAR1\xff\xfe", TARGET),
    "UTF-16": ("a.yaml", "epoch: x\n".encode("utf-16"), "expected YAML in UTF-8 ("),
    "Latin-1": ("a.yaml", "results: Gr\u00f6\u00dfe\n".encode("latin-1"), "expected YAML in UTF-8 ("),
    "tab": ("a.yaml", b"seed:\n\tnoise: 1\n", "expected YAML (a tab begins line 2"),
    "empty": ("a.yaml", b"", "expected a mapping of settings, got nothing"),
    "anchor in itself": ("a.yaml", b"seed: &s {noise: *s}\n", "expected YAML ("),
    "list": ("a.yaml", b"- epoch\n", "expected a mapping of settings, got list"),
}


@pytest.mark.parametrize(("name", "content", "told"), WRONG.values(), ids=WRONG)
def test_a_file_behind_configfile_that_holds_no_settings_is_told(here, name, content, told):
    (here / "good.yaml").write_text("epoch: x\n")
    if content is not None:
        (here / name).write_bytes(content)
    line = ended(check_settings, ["-j2", "--configfile", "good.yaml", name, "-n"])
    assert line.startswith(f"opml: {name}: {told}")
    assert "\n" not in line


def test_a_target_behind_config_is_told(here):
    line = ended(check_settings, ["--config", "duration_days=3", "results/x.pdf", "-n"])
    assert line == (
        "opml: results/x.pdf: expected KEY=VALUE after --config; targets are before it, or after --"
    )


def test_other_arguments_are_not_taken_for_settings(here):
    (here / "good.yaml").write_text("epoch: x\n")
    check_settings(["study", "--configfile", "good.yaml", "--", "results/x.pdf"])
    check_settings(["study", "--configfile=good.yaml", "results/x.pdf", "--config", "a=b", "-j", "2"])


def test_a_folder_without_a_project_is_told_with_the_way_to_one(here):
    line = ended(before_first_job.project_settings)
    assert line == (
        f"opml: config/config.yaml: no such file in {here}; --directory names the folder of another project"
    )


def test_a_folder_of_results_that_takes_no_file_is_told(here, monkeypatch):
    def refuse(_):
        raise PermissionError(13, os.strerror(13))

    monkeypatch.setattr(before_first_job.lock, "hold", refuse)
    line = ended(before_first_job.hold_results, "results")
    assert line == "opml: results: expected a folder that can be written to, got Permission denied"
