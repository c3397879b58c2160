"""What the environment's data reach, told of a run's settings before any job starts."""

import pytest
from support import EPOCH, REPOSITORY

from opml.environment import coverage
from opml.errors import InputError
from opml.study.overlay import read_yaml

VALUES = read_yaml(REPOSITORY / "config" / "config.yaml")


def refusal(*, epoch=EPOCH, **sources):
    with pytest.raises(InputError) as error:
        coverage.check(VALUES | {"epoch": epoch, "environment": VALUES["environment"] | sources})
    return str(error.value)


def test_the_papers_run_is_covered():
    coverage.check(VALUES)


def test_packaged_activity_that_ends_too_early_is_told_with_its_setting_and_what_to_do():
    assert refusal(epoch="2018-09-28T12:09:45") == (
        "environment.solar_activity: MSAFE reaches from 2016-08-01 to 2017-01-01, "
        "this run needs 2018-09-28 to 2018-11-17; for other dates give the path of a bulletin"
    )
    assert refusal(epoch="2016-12-01T00:00:00", true_solar_activity="OBSERVED").startswith(
        "environment.solar_activity: MSAFE reaches from"
    )


def test_observed_weather_is_told_alike():
    # Its first day lacks the flux of the day before, its last one the flux after the measurement.
    assert refusal(epoch="2017-02-01T00:00:00", solar_activity="OBSERVED") == (
        "environment.solar_activity: OBSERVED reaches from 2016-07-03 to 2017-02-27, "
        "this run needs 2017-01-31 to 2017-03-23; for other dates give the path of a bulletin"
    )


def test_a_file_of_ones_own_is_told_by_its_name(tmp_path):
    text = (REPOSITORY / "src" / "opml" / "data" / "msafe.tsv").read_text()
    (tmp_path / "sun.tsv").write_text(text.split("2016-11")[0])
    line = refusal(solar_activity=str(tmp_path / "sun.tsv"))
    assert line.startswith("sun.tsv: epoch: expected dates from 2016-08-01 to 2016-10-01, got 2016-09-28 to")
