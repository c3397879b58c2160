"""TDM: tracks come back, and what is malformed is named by file and line."""

import numpy as np
import pandas as pd
import pytest
from support import EPOCH

from opml.catalog import tracking, truth
from opml.dynamics.ensemble import Integrator
from opml.errors import InputError
from opml.interop import tdm


@pytest.fixture(scope="module")
def table(kepler_model, iss, earth_orientation, three_stations):
    """Half a day of the paper's RSO over the paper's stations."""
    orbit = truth.simulate(kepler_model, iss, duration=43200.0, step=20.0, integrator=Integrator())
    return tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=42)


@pytest.fixture
def message(table, tmp_path):
    path = tmp_path / "iss.tdm"
    tdm.write(path, table, epoch=EPOCH, rso="iss")
    return path


def test_tracks_come_back(table, message):
    back = tdm.read(message, epoch=EPOCH)
    by_station = ["t", "station"]
    back, given = (frame.sort_values(by_station, ignore_index=True) for frame in (back, table[tdm.COLUMNS]))
    assert given["station"].nunique() > 1 < given["track"].nunique() < len(given) / 10
    exact = ["track", "t", "station", "range"]
    pd.testing.assert_frame_equal(back[exact], given[exact], check_exact=True)
    # Degrees in between: a double has not for every radian a degree that leads back, but one next to it.
    for name in ("azimuth", "elevation"):
        np.testing.assert_array_max_ulp(back[name].to_numpy(), given[name].to_numpy(), maxulp=1)


def test_a_segment_is_a_station_and_a_track(table, message):
    assert message.read_text().count("META_START") == len(table.groupby(["track", "station"]))


def test_segments_without_an_id_are_tracks_of_their_own(message):
    lines = message.read_text().splitlines(keepends=True)
    message.write_text("".join(line for line in lines if not line.startswith("TRACK_ID")))
    back = tdm.read(message, epoch=EPOCH)
    assert back["track"].nunique() == message.read_text().count("META_START")
    assert back.groupby("track", sort=False)["t"].min().is_monotonic_increasing


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("CCSDS_TDM_VERS = 2.0", "CCSDS_OEM_VERS = 2.0", "line 1: expected CCSDS_TDM_VERS = 1.0 or 2.0"),
        ("PATH = 2,1", "PATH = 1,2,1", "line 16: expected PATH = 2,1, got 1,2,1"),
        ("ANGLE_TYPE = AZEL", "ANGLE_TYPE = RADEC", "line 18: expected ANGLE_TYPE = AZEL, got RADEC"),
        ("RANGE_UNITS = km", "RANGE_UNITS = s", "line 17: expected RANGE_UNITS = KM, got s"),
        ("DATA_START\n", "", "line 20: expected DATA_START, got ANGLE_1"),
        (
            "ANGLE_2 = ",
            "DOPPLER = ",
            "line 22: expected ANGLE_1 or ANGLE_2 or RANGE = time value",
        ),
        ("ANGLE_2 = ", "ANGLE_1 = ", "line 22: expected ANGLE_1 once at a time, got ANGLE_1"),
        ("ANGLE_2 = ", "COMMENT ", "line 21: expected ANGLE_2 at 2016-"),
        ("RANGE = 2016-", "RANGE = nan 2016-", "line 23: expected ANGLE_1 or ANGLE_2 or RANGE = time value"),
        ("RANGE = 2016-", "RANGE = 2016_", "line 21: expected RANGE at 2016-"),
    ],
)
def test_what_is_malformed_is_named_by_file_and_line(message, old, new, said):
    text = message.read_text()
    assert old in text
    message.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as error:
        tdm.read(message, epoch=EPOCH)
    assert str(error.value).startswith(f"{message}: {said}")


def test_a_cut_file_is_noticed(message):
    text = message.read_text()
    for size in (0, 30, 300, 500, len(text) - 5):
        message.write_text(text[:size])
        with pytest.raises(InputError, match="expected"):
            tdm.read(message, epoch=EPOCH)
