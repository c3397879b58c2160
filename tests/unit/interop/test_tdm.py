"""TDM: tracks come back, and what is malformed is named by file and line."""

import re

import erfa
import numpy as np
import pandas as pd
import pytest
from support import EPOCH, edited, refusal, refusals

from opml.base.errors import InputError
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.interop import ccsds, tdm


@pytest.fixture(scope="module")
def table(kepler_model, iss, earth_orientation, three_stations):
    """Half a day of the paper's RSO over the paper's stations."""
    orbit = truth.simulate(Propagator(kepler_model, iss), duration=43200.0, step=20.0)
    return tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=42)


@pytest.fixture
def message(table, tmp_path):
    path = tmp_path / "iss.tdm"
    tdm.write(path, table, epoch=EPOCH, rso="iss")
    return path


def read(path):
    """The measurements of a message in order of time."""
    return tdm.measurements([path], epoch=EPOCH).sort_values("t", kind="stable", ignore_index=True)


def test_tracks_come_back(table, message):
    by = ["t", "station"]
    back, given = (frame.sort_values(by, ignore_index=True) for frame in (read(message), table))
    assert given["station"].nunique() > 1 < given["track"].nunique() < len(given) / 10
    assert pd.factorize(back["track_id"])[0].tolist() == given["track"].tolist()
    columns = tdm.COLUMNS[1:]
    pd.testing.assert_frame_equal(back[columns], given[columns], check_exact=True)


def test_messages_in_a_row_are_read_and_one_object_of_several_is_chosen(table, message):
    ours = message.read_text()
    message.write_text(ours + ours.replace("= iss", "= 1998-067A"))
    for wanted in ("iss", "1998-067a"):
        found = tdm.measurements([message], epoch=EPOCH, wanted=wanted)
        assert (len(found), set(found["rso"].str.lower())) == (len(table), {wanted})
    with pytest.raises(InputError, match=r"iss.tdm: expected tracks of mir, got those of iss, 1998-067A"):
        tdm.measurements([message], epoch=EPOCH, wanted="mir")
    assert "expected tracks of iss, as in" in refusal(read, message)


@pytest.mark.parametrize(("old", "new", "line"), refusals("tdm"))
def test_what_is_malformed_is_named_by_file_and_line(message, old, new, line):
    assert refusal(read, edited(message, old, new)).startswith(f"{message}: {line}")


def test_a_cut_file_is_noticed(message):
    text = message.read_text()
    for size in (0, 30, 300, 500, len(text) - 5):
        message.write_text(text[:size])
        assert "expected" in refusal(read, message)


def changed(path, *pairs):
    text = path.read_text()
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)


def test_stars_on_axes_of_eme2000_are_turned(table, tmp_path):
    """EME2000 is off GCRF by 23 milliarcseconds at most, and less about the pole than along the equator."""
    stars = table.assign(right_ascension=table["azimuth"], declination=table["elevation"])
    stars[["azimuth", "elevation", "range"]] = np.nan
    path = tmp_path / "stars.tdm"
    tdm.write(path, stars, epoch=EPOCH, rso="iss")
    as_written = read(path)
    changed(path, ("REFERENCE_FRAME = ICRF", "REFERENCE_FRAME = EME2000"))
    turned = read(path)

    def sights(rows):
        right_ascension, declination = rows["right_ascension"], rows["declination"]
        level = np.cos(declination)
        return np.column_stack(
            [level * np.cos(right_ascension), level * np.sin(right_ascension), np.sin(declination)]
        )

    expected = sights(as_written) @ erfa.bp06(2451545.0, 0.0)[0]
    np.testing.assert_allclose(sights(turned), expected, atol=1e-15)
    apart = np.degrees(np.linalg.norm(sights(turned) - sights(as_written), axis=1)) * 3600e3
    assert 5.0 < apart.max() < 30.0


def test_ranges_there_and_back_stay_so(table, tmp_path):
    both = table.assign(two_way=table["station"] == "eglin")
    path = tmp_path / "both.tdm"
    tdm.write(path, both, epoch=EPOCH, rso="iss")
    text = path.read_text()
    assert text.count("PATH = 1,2,1") == table.loc[table["station"] == "eglin", "track"].nunique()
    back = read(path)
    assert set(back.loc[back["two_way"], "station"]) == {"eglin"}
    assert set(back.loc[~back["two_way"], "station"]) == {"clear", "kaena"} & set(table["station"])


def test_rates_may_stand_at_other_times_than_ranges(message, table):
    lines = message.read_text().splitlines()
    at = next(k for k, line in enumerate(lines) if line == "DATA_START")
    time = lines[at + 1].split()[2].replace(".000000", ".500000")
    lines.insert(at + 4, f"DOPPLER_INSTANTANEOUS = {time} -1.25")
    message.write_text("\n".join(lines))
    back = read(message)
    assert len(back) == len(table) + 1
    assert back["range_rate"].dropna().tolist() == [-1250.0]
    assert back.loc[back["range_rate"].notna(), "range"].isna().all()


def test_one_angle_to_the_stars_is_none(message):
    lines = [line for line in message.read_text().splitlines() if not line.startswith("ANGLE_2 ")]
    message.write_text("\n".join(lines))
    changed(message, ("ANGLE_TYPE = AZEL", "ANGLE_TYPE = RADEC\nREFERENCE_FRAME = ICRF"))
    assert "line 18: expected ANGLE_1 and ANGLE_2, got one of them" in refusal(read, message)


def test_degraded_segments_are_left_out_and_told(message, caplog):
    table = read(message)
    message.write_text(message.read_text().replace("MODE =", "DATA_QUALITY = DEGRADED\nMODE =", 1))
    left = read(message)
    assert 0 < len(left) < len(table)
    assert caplog.messages == [f"{message}: a segment of degraded data is ignored"]


@pytest.mark.parametrize("path", ["1,2", "2,1,2"])
def test_the_last_one_of_a_path_is_the_station(table, message, path):
    changed(
        message,
        ("PARTICIPANT_1", "PARTICIPANT_X"),
        ("PARTICIPANT_2", "PARTICIPANT_1"),
        ("PARTICIPANT_X", "PARTICIPANT_2"),
        ("PATH = 2,1", f"PATH = {path}"),
    )
    assert set(read(message)["station"]) == set(table["station"])


def test_what_is_not_estimated_from_is_passed_over(table, message):
    lines = message.read_text().splitlines()
    rates = [line.replace("RANGE", "DOPPLER_INTEGRATED") for line in lines if line.startswith("RANGE = ")]
    block = ["META_START", "TIME_SYSTEM = UTC", "META_STOP", "DATA_START", *rates, "DATA_STOP"]
    for k, line in reversed(list(enumerate(lines))):
        if line.startswith("RANGE = "):
            lines.insert(k, "RECEIVE_FREQ_1 = 2016-09-28T13:00:00 2.0E9")
    message.write_text("\n".join([*lines, *block]))
    assert len(read(message)) == len(table)


@pytest.mark.parametrize(("scale", "ahead"), [("TAI", 36.0), ("GPS", 17.0), ("TT", 68.184)])
def test_times_in_other_systems_are_converted(table, message, scale, ahead):
    changed(message, ("TIME_SYSTEM = UTC", f"TIME_SYSTEM = {scale}"))
    np.testing.assert_allclose(np.sort(table["t"]) - read(message)["t"], ahead, atol=1e-6)


def test_corrections_that_were_not_applied_are_added(table, message):
    given = "CORRECTION_RANGE = -0.5\nCORRECTION_ANGLE_2 = 0.1\nCORRECTIONS_APPLIED = NO\nPATH"
    changed(message, ("PATH", given))
    by = ["t", "station"]
    back, given = (frame.sort_values(by) for frame in (read(message), table))
    np.testing.assert_allclose(back["range"].to_numpy(), given["range"] - 500.0)
    np.testing.assert_allclose(back["elevation"].to_numpy(), given["elevation"] + np.radians(0.1))
    assert back["azimuth"].tolist() == given["azimuth"].tolist()
    changed(message, ("CORRECTIONS_APPLIED = NO", "CORRECTIONS_APPLIED = YES"))
    assert read(message).sort_values(by)["range"].tolist() == given["range"].tolist()
    changed(message, ("CORRECTIONS_APPLIED = YES\n", ""))
    assert "expected the key CORRECTIONS_APPLIED before this line, got none" in refusal(read, message)


@pytest.mark.parametrize(("old", "new", "expected"), refusals("tdm_of_others"))
def test_messages_that_are_mixed_up_are_named_by_file_and_line(message, old, new, expected):
    where, _, what = refusal(read, edited(message, old, new)).partition(": expected")
    line = message.read_text().splitlines()[int(where.split("line ")[1]) - 1]
    assert line.startswith("ANGLE_1")
    assert f"expected{what}" == expected.format(message)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 0.1, 1.0, np.pi, 6.283185307179586, 1.2345678901234567e-5])
def test_every_angle_comes_back_from_17_digits(angle):
    near = [angle, *(np.nextafter(angle, side) for side in (-1.0, 7.0))]
    for one in near:
        text = ccsds.degrees_text(one)
        assert ccsds.radians("", 1, text) == one
        assert len(text.partition("E")[0].replace(".", "").lstrip("-0")) <= 17


def test_an_angle_beyond_a_turn_is_refused(message):
    text = message.read_text()
    message.write_text(
        re.sub(r"^ANGLE_1 = (\S+) \S+", r"ANGLE_1 = \1 400.5", text, count=1, flags=re.MULTILINE)
    )
    with pytest.raises(InputError, match=r"line \d+: expected an angle of -360 to 360 deg, got 400\.5"):
        read(message)
