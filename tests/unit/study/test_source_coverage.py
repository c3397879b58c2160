"""What the environment's data reach, told of a run's settings before any job starts."""

import pytest
from support import EPOCH, REPOSITORY, refusals

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.yaml_files import read_yaml
from opml.environment import gravity_field, nodes, solar_activity
from opml.study import source_coverage
from opml.study.settings.model.whole import RunSettings

VALUES = read_yaml(REPOSITORY / "config" / "config.yaml") | {"study": None}
REACH = {name: solar_activity.reach(name) for name in solar_activity.PACKAGED}


def check(values):
    """Look whether a run of these settings is covered."""
    source_coverage.check(RunSettings(**values))


def refusal(*, epoch=EPOCH, **sources):
    with pytest.raises(InputError) as error:
        check(VALUES | {"epoch": epoch, "environment": VALUES["environment"] | sources})
    return str(error.value)


def check_within_reach(values):
    """Assert that a run is covered, and that what is told of the packaged activity says so too."""
    check(values)
    ends = nodes(values["epoch"], DAY * values["duration_days"])[[0, -1]]
    begin, end = (epochs.calendar_day(values["epoch"], t) for t in ends)
    for first, last in REACH.values():
        assert first <= begin
        assert end <= last


def test_the_papers_run_is_covered_and_one_of_thirty_years_is_not():
    check_within_reach(VALUES)
    with pytest.raises(InputError, match="finals2000A"):
        check(VALUES | {"duration_days": 30 * 365.25})


def test_packaged_activity_that_ends_too_early_is_told_with_its_setting_and_what_to_do():
    assert refusal(epoch="1998-08-20T12:09:45") == (
        "environment.solar_activity: MSAFE reaches from 1998-09-01 to 2041-10-01, "
        "this run needs 1998-08-20 to 1998-10-09; for other dates give the path of a bulletin"
    )
    assert refusal(epoch="1997-12-01T00:00:00", true_solar_activity="OBSERVED").startswith(
        "environment.solar_activity: MSAFE reaches from"
    )


@pytest.mark.parametrize("year", range(1999, 2026))
def test_a_run_of_any_year_since_the_first_bulletin_is_covered(year):
    sources = VALUES["environment"] | {"true_solar_activity": "OBSERVED"}
    check_within_reach(VALUES | {"epoch": f"{year}-06-15T06:00:00", "environment": sources})


def test_observed_weather_is_told_alike():
    # Its first day lacks the flux of the day before, its last one the flux after the measurement.
    assert refusal(epoch="1995-12-01T00:00:00", solar_activity="OBSERVED") == (
        "environment.solar_activity: OBSERVED reaches from 1995-12-31 to 2026-01-13, "
        "this run needs 1995-11-30 to 1996-01-20; for other dates give the path of a bulletin"
    )


def test_a_file_of_ones_own_is_told_by_its_name(tmp_path):
    text = (REPOSITORY / "src" / "opml" / "data" / "msafe.tsv").read_text()
    head, months = text.split("1998-09")[0], text.split("2016-11")[0].split("\n2016-08")[1]
    (tmp_path / "sun.tsv").write_text(f"{head}2016-08{months}")
    line = refusal(solar_activity=str(tmp_path / "sun.tsv"))
    assert line.startswith("sun.tsv: epoch: expected dates from 2016-08-01 to 2016-10-01, got 2016-09-28 to")


@pytest.mark.parametrize(("sources", "expected"), refusals("knowledge"))
def test_knowledge_that_the_source_does_not_have_is_told(sources, expected):
    assert refusal(**sources).startswith(f"environment.knowledge: {expected}")


def test_too_short_a_past_or_history_is_told(tmp_path):
    asked = {"knowledge": "forecast", "solar_activity": "OBSERVED"}
    early = {"epoch": "1996-02-10T00:00:00", **asked}
    assert "expected dates from 1996-03-20" in refusal(**early | {"knowledge": "hindcast"})
    assert refusal(epoch="1996-08-10T00:00:00", **asked).startswith(
        "environment.knowledge: forecast: forecast: expected 411 days of packaged weather before the epoch"
    )
    lines = solar_activity.read_text(solar_activity.resolve("OBSERVED")).splitlines()
    short = tmp_path / "short.csv"
    short.write_text("\n".join(line for line in lines if not line[0].isdigit() or line >= "2016-07-12"))
    environment = VALUES["environment"] | asked | {"solar_activity": str(short)}
    with pytest.raises(InputError, match=r"epoch: expected dates from 2016-10-02 to "):
        check(VALUES | {"environment": environment})
    check(VALUES | {"environment": VALUES["environment"] | asked})


@pytest.mark.parametrize("model", ["truth", "assumed"])
def test_tides_want_a_field_that_tells_its_tide_system(model, tmp_path):
    path = tmp_path / "field.gfc"
    text = gravity_field.resolve("EGM2008").read_text()
    models = VALUES["force_models"] | {model: VALUES["force_models"][model] | {"forces": ["solid_tides"]}}
    values = VALUES | {
        "force_models": models,
        "environment": VALUES["environment"] | {"gravity_field": str(path)},
    }
    for tide_system in ("tide_free", "zero_tide"):
        path.write_text(text.replace(" tide_free", f" {tide_system}"))
        check(values)
    path.write_text(text.replace(" tide_free", " mean_tide"))
    with pytest.raises(InputError) as error:
        check(values)
    assert str(error.value) == (
        f"force_models.{model}.forces: solid_tides: expected a gravity field that is tide_free or zero_tide, "
        "got tide_system mean_tide"
    )
