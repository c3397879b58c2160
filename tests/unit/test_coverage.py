"""What the environment's data reach, told of a run's settings before any job starts."""

import pytest
from support import EPOCH, REPOSITORY

from opml.environment import coverage
from opml.errors import InputError
from opml.reading import read_yaml

VALUES = read_yaml(REPOSITORY / "config" / "config.yaml")


def refusal(*, epoch=EPOCH, **sources):
    with pytest.raises(InputError) as error:
        coverage.check(VALUES | {"epoch": epoch, "environment": VALUES["environment"] | sources})
    return str(error.value)


def test_the_papers_run_is_covered():
    coverage.check(VALUES)


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
    coverage.check(VALUES | {"epoch": f"{year}-06-15T06:00:00", "environment": sources})


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
