"""Settings of a job: each script declares those that it takes, which its rule has to give."""

import re

import pytest
from pydantic import ValidationError
from support import REPOSITORY

from opml.base.section import JobSettings

SCRIPTS = sorted((REPOSITORY / "workflow" / "scripts").glob("*.py"))


class Settings(JobSettings):
    seed: int


def test_a_job_takes_what_it_declares_and_leaves_the_rest():
    assert Settings(seed=42, epoch="2016-09-28T12:09:45") == Settings(seed=42)


def test_a_setting_that_the_rule_does_not_give_is_an_error():
    with pytest.raises(ValidationError, match="seed"):
        Settings(epoch="2016-09-28T12:09:45")


def test_no_script_reads_a_setting_by_a_key():
    by_key = re.compile(r"""\bsettings\[["']""")
    assert [path.name for path in SCRIPTS if by_key.search(path.read_text(encoding="utf-8"))] == []
