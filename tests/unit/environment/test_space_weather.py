"""Observed space weather: both forms of CSSI's files, and what DTM2000 is given of them."""

import gzip

import numpy as np
import pandas as pd
import pytest
from support import refusal, refusals, shared

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.environment import known_weather, nodes, solar_activity, space_weather

EPOCH = "2016-09-28T12:09:45"
CSV = """# a comment
DATE,ND,KP1,KP2,KP3,KP4,KP5,KP6,KP7,KP8,KP_SUM,F10.7_OBS,F10.7_ADJ,F10.7_DATA_TYPE,F10.7_OBS_CENTER81
2016-12-28,1,0,3,7,10,13,17,20,23,93,70.0,1.0,OBS,75.0
2016-12-29,2,27,30,33,37,40,43,47,50,307,80.0,1.0,OBS,77.0
2016-12-30,3,0,0,0,0,0,0,0,0,0,90.0,1.0,OBS,79.0
2016-12-31,4,10,10,10,10,10,10,10,10,80,91.0,1.0,PRD,81.0
2017-02-01,5,,,,,,,,,,92.0,1.0,PRM,82.0
"""


def fixed_columns(line):
    """A day of the comma-separated form in the fixed columns of SpaceWeather-All-v1.2.txt."""
    day, _, *kp, total, flux, _, _, mean = line.split(",")
    return (
        f"{day.replace('-', ' ')} 2501 22"
        + "".join(f"{figure:>3}" for figure in kp)
        + f"{total:>4}{8 * '   7'}   5 0.2 0   0   1.0 0   1.0   1.0{flux:>6}{mean:>6}   1.0\n"
    )


DAYS = [fixed_columns(line) for line in CSV.splitlines()[2:]]
TEXT = f"""DATATYPE CssiSpaceWeather
VERSION 1.2
# FORMAT(I4,I3,I3,I5,I3,8I3,I4,8I4,I4,F4.1,I2,I4,F6.1,I2,5F6.1)
NUM_OBSERVED_POINTS 3
BEGIN OBSERVED
{"".join(DAYS[:3])}END OBSERVED

NUM_DAILY_PREDICTED_POINTS 1
BEGIN DAILY_PREDICTED
{DAYS[3]}END DAILY_PREDICTED
BEGIN MONTHLY_PREDICTED
{DAYS[4]}END MONTHLY_PREDICTED
"""
FORMS = pytest.mark.parametrize("text", [CSV, TEXT], ids=["csv", "text"])


@pytest.fixture
def weather(tmp_path):
    """Writes a file's text and gives its path."""

    def write(text=CSV):
        path = tmp_path / "weather.txt"
        path.write_text(text)
        return path

    return write


def activity(path, *utc):
    t = np.array([epochs.seconds_between(EPOCH, text) for text in utc])
    return solar_activity.tabulate(path, EPOCH, t, 50)


@FORMS
def test_flux_is_of_the_day_before_and_linear_between_the_measurements(weather, text):
    found = activity(weather(text), "2016-12-29T20:00:00", "2016-12-30T14:00:00", "2016-12-30T20:00:00")
    assert found["f107"].tolist() == pytest.approx([70.0, 77.5, 80.0])
    assert found["f107_mean"].tolist() == pytest.approx([77.0, 78.5, 79.0])


@FORMS
def test_kp_lags_by_three_hours_and_its_mean_spans_twenty_four(weather, text):
    found = activity(weather(text), "2016-12-30T00:00:00", "2016-12-30T02:59:59", "2016-12-30T03:00:00")
    # The last interval of the 29th has Kp 5; then the first of the 30th, 0.
    assert found["kp_3h"].tolist() == pytest.approx([5.0, 5.0, 0.0])
    thirds = np.arange(8, 16) / 3.0
    assert found["kp_24h"].tolist() == pytest.approx([thirds.mean()] * 2 + [(thirds.sum() - 8 / 3) / 8])


@FORMS
def test_kp_comes_in_thirds(weather, text):
    kp = space_weather.read("w", text)[space_weather.KP].to_numpy()[:2].ravel()
    np.testing.assert_array_equal(kp, np.arange(16) / 3.0)


@FORMS
def test_monthly_predictions_have_no_kp_and_end_the_file(weather, text):
    assert len(space_weather.read("w", text)) == 4
    activity(weather(text), "2016-12-31T19:59:00")
    with pytest.raises(
        InputError, match=r"^weather\.txt: epoch: expected dates from 2016-12-30 to 2016-12-30"
    ):
        activity(weather(text), "2016-12-31T20:01:00")


def test_before_the_first_day_of_flux_and_kp_is_refused(weather):
    activity(weather(), "2016-12-29T20:00:01")
    assert "expected dates" in refusal(activity, weather(), "2016-12-29T19:59:00")


@pytest.mark.parametrize("epoch", [EPOCH, "2016-09-28T12:09:45.3", "2016-09-28T11:59:59.999"])
def test_steps_fall_on_whole_hours_however_the_epoch_rounds(epoch):
    t = nodes(epoch, 50 * DAY)
    found = solar_activity.tabulate("OBSERVED", epoch, t, 50)
    changed = np.flatnonzero(np.diff(found["kp_3h"])) + 1
    midnight = epochs.seconds_between(epoch, "2016-09-28T00:00:00")
    intervals = (t[changed] - midnight) / 10800.0
    np.testing.assert_allclose(intervals, np.round(intervals), rtol=0, atol=1e-6)
    assert len(changed) > 200


@pytest.mark.parametrize(
    ("day", "kp", "flux", "mean"),
    [
        ("1996-01-02", [5, 0, 2, 3, 3, 8, 7, 11], 74.8, 73.2),
        # The storm of October 2003: Kp 9 three times. Means of 146.8 and 146.5, less the burst of November 4.
        ("2003-10-29", [14, 12, 27, 24, 23, 23, 26, 26], 291.7, 142.472839506),
        ("2003-10-30", [26, 22, 16, 14, 15, 21, 27, 27], 271.4, 142.172839506),
        ("2014-10-23", [4, 6, 6, 6, 7, 5, 10, 6], 227.1, 153.2),
        ("2026-01-13", [10, 8, 5, 6, 1, 3, 7, 6], 116.6, 149.5),
    ],
)
def test_the_packaged_weather_is_what_was_observed_since_1996(day, kp, flux, mean):
    following = epochs.calendar(epochs.utc(f"{day}T00:00:00", 0.0)[0] - epochs.MJD_ZERO + 1.0)
    assert activity("OBSERVED", f"{day}T20:00:00")["f107_mean"].item() == pytest.approx(mean)
    assert activity("OBSERVED", f"{following}T20:00:00")["f107"].item() == pytest.approx(flux)
    evening = [f"{day}T{hour:02d}:00:00" for hour in range(3, 24, 3)]
    found = activity("OBSERVED", *evening, f"{following}T00:00:00")
    assert found["kp_3h"].tolist() == pytest.approx([third / 3 for third in kp])
    assert found["kp_24h"].iloc[-1] == pytest.approx(sum(kp) / 24)


def test_the_packaged_weather_reaches_from_1996_to_2026_and_not_a_second_further():
    assert solar_activity.reach("OBSERVED") == ("1995-12-31", "2026-01-13")
    begin, end = (
        epochs.seconds_between(EPOCH, text) for text in ("1995-12-30T20:00:00", "2026-01-14T20:00:00")
    )
    assert solar_activity.tabulate("OBSERVED", EPOCH, np.array([begin, end]), 50).notna().all(axis=None)
    for beyond in (begin - 1.0, end + 1.0):
        with pytest.raises(
            InputError, match=r"^space_weather\.csv: epoch: expected dates from 1995-12-31 to 2026-01-13"
        ):
            solar_activity.tabulate("OBSERVED", EPOCH, np.array([0.0, beyond]), 50)


@pytest.mark.parametrize(
    "epoch", ["1996-01-01T00:00:00", EPOCH, "2008-12-20T06:00:00", "2025-11-20T00:00:00"]
)
def test_the_packaged_weather_gives_what_the_whole_of_celestraks_file_does(weather, epoch):
    whole = weather(gzip.decompress(shared("real/SW-All.csv.gz").read_bytes()).decode())
    t = nodes(epoch, 50 * DAY)
    ours, theirs = (solar_activity.tabulate(source, epoch, t, 50) for source in ("OBSERVED", whole))
    exact = ["t", "f107", "f107_mean", "kp_3h"]
    pd.testing.assert_frame_equal(ours[exact], theirs[exact], check_exact=True)
    # The sums may start elsewhere where the packaged table has no 89 days before.
    pd.testing.assert_frame_equal(ours, theirs, check_exact=epoch[:4] != "1996", rtol=1e-13)


def test_kp_steps_on_the_hour_of_a_day_with_a_leap_second_too():
    # Kp of 2015-06-30, 1o 2o 1+ 0+ 1- 1o 2- 2+, in thirds.
    kp = [3, 6, 4, 1, 2, 3, 5, 7]
    hours = [f"2015-06-30T{hour:02d}:00:00" for hour in range(3, 24, 3)] + ["2015-07-01T00:00:00"]
    steps = np.array([epochs.seconds_between(EPOCH, hour) for hour in hours])
    at, before = (solar_activity.tabulate("OBSERVED", EPOCH, t, 50)["kp_3h"] for t in (steps, steps - 2.0))
    assert at.tolist() == pytest.approx([third / 3 for third in kp])
    assert before.tolist()[1:] == pytest.approx([third / 3 for third in kp[:-1]])


def test_flux_is_of_the_day_before_on_a_day_with_a_leap_second_too(weather):
    # Half way in time between the measurements of the 29th and the 30th, a day later.
    assert activity(weather(), "2016-12-31T08:00:00")["f107"].tolist() == pytest.approx([85.0], abs=1e-9)


@pytest.mark.parametrize(("old", "new", "message"), refusals("space_weather"))
def test_what_cannot_be_used_is_named_in_one_line(weather, old, new, message):
    path = weather(CSV.replace(old, new))
    assert f"weather.txt: {message}" in refusal(activity, path, "2016-12-30T12:00:00")


@pytest.mark.parametrize("cells", [1, 4, 8])
def test_a_day_that_is_cut_before_its_last_kp_is_left_out_and_told(weather, cells, caplog):
    lines = CSV.splitlines()
    last = max(k for k, line in enumerate(lines) if ",OBS" in line)
    path = weather("\n".join([*lines[:last], ",".join(lines[last].split(",")[:cells])]))
    space_weather.read(path, path.read_text())
    assert f"line {last + 1}: day left out, without eight Kp: is the file cut?" in caplog.text


def test_a_predicted_day_between_measured_ones_is_told(weather):
    path = weather(CSV.replace("80.0,1.0,OBS", "80.0,1.0,PRD"))
    assert "line 5: expected a predicted day after another" in refusal(known_weather.read, path)
    assert len(known_weather.read(weather(CSV)).flux) == 3


@pytest.mark.parametrize(
    ("day", "usual"), [("2011-03-07", 126.8), ("2005-09-09", 84.2), ("2006-12-06", 86.9)]
)
def test_a_burst_of_the_sun_is_no_weather(day, usual, caplog):
    """Of 938.6, 707.6 and 573.4 sfu in the hour of the measurement: densities were 0 or no numbers."""
    caplog.set_level("INFO")
    t = epochs.seconds_between(EPOCH, f"{day}T20:00:00") + np.arange(-2.0, 3.0) * DAY
    found = solar_activity.tabulate("OBSERVED", EPOCH, t, 50)
    assert found["f107"].iloc[3] == pytest.approx(usual, abs=3.0)
    assert found["f107"].max() < 170.0
    assert np.ptp(found["f107_mean"]) < 3.0
    assert "fluxes replaced that are bursts" in caplog.text
