"""Settings of a job as attributes: scripts read those that are declared, and nothing by a key."""

import re
from typing import get_type_hints

import pytest
from support import REPOSITORY

from opml.workflow import job_settings
from opml.workflow.job_settings import FigureSettings, JobSettings

SCRIPTS = sorted((REPOSITORY / "workflow" / "scripts").glob("*.py"))


def test_a_setting_is_an_attribute_and_all_of_them_a_mapping():
    settings = JobSettings({"epoch": "2016-09-28T12:09:45", "seed": 42})
    assert (settings.epoch, settings.seed) == ("2016-09-28T12:09:45", 42)
    assert settings.values == {"epoch": "2016-09-28T12:09:45", "seed": 42}


def test_a_setting_that_the_rule_does_not_give_is_an_error():
    with pytest.raises(AttributeError, match="level"):
        FigureSettings({"epoch": "2016-09-28T12:09:45"}).level  # noqa: B018


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_reads_settings_that_are_declared(script):
    text = script.read_text(encoding="utf-8")
    assert not re.search(r"""\bsettings\[["']""", text)
    kinds = set(re.findall(r"\b(\w+)\(snakemake\.params\.settings\)", text)) - {"read_study"}
    read = set(re.findall(r"\bsettings\)?\.([a-z_]+)", text)) - {"values"}
    assert len(kinds) == bool(read) or not read
    declared = {name for kind in kinds for name in get_type_hints(getattr(job_settings, kind))}
    assert read <= declared | {"params"}
