"""Tracks that were measured: what is a track, what is refused, and in which line."""

import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import EPOCH, refusals, stations

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.fit import measured_tracks, refraction
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.catalog.simulate.observing import observe, place, site
from opml.interop import tdm

A_DAY = DAY


@pytest.fixture(scope="module")
def table(kepler_model, iss, earth_orientation, three_stations):
    """A day of the paper's RSO over the paper's stations."""
    orbit = truth.simulate(Propagator(kepler_model, iss), duration=A_DAY, step=20.0)
    return tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=42)


@pytest.fixture
def message(table, tmp_path):
    path = tmp_path / "iss.tdm"
    tdm.write(path, table, epoch=EPOCH, rso="iss")
    return path


def read(*paths):
    return tdm.measurements(paths, epoch=EPOCH)


def test_what_was_exported_comes_back_to_the_bit(table, message, three_stations):
    back = measured_tracks.tracks(read(message), three_stations)
    pd.testing.assert_frame_equal(back[tdm.COLUMNS], table[tdm.COLUMNS], check_exact=True)
    assert back.filter(like="_true").isna().all(axis=None)


def test_places_are_where_they_are_observed(three_stations):
    position, to_horizon = site(three_stations[0])
    positions = position + np.random.default_rng(2).normal(size=(5, 3)) * 1e6
    back = place(observe(positions, position, to_horizon), position, to_horizon)
    np.testing.assert_allclose(back, positions, rtol=1e-12)


def test_air_is_taken_off_what_a_station_measures_through_it(table, message, three_stations):
    through = [replace(station, troposphere=1.0, refraction=1.0) for station in three_stations]
    found, given = measured_tracks.tracks(read(message), through), table
    station = three_stations[0]
    ours, before = (rows[rows["station"] == station.name] for rows in (found, given))
    high = before["elevation"].to_numpy()
    lifted = refraction.bending(high, station.altitude, radio=True)
    late = refraction.delay(high - lifted, station.latitude, station.altitude)
    assert late.max() > 20.0
    np.testing.assert_allclose(ours["elevation"], high - lifted)
    np.testing.assert_allclose(ours["range"], before["range"] - late)
    assert ours["azimuth"].tolist() == before["azimuth"].tolist()
    message.write_text(message.read_text().replace("PATH", "CORRECTIONS_APPLIED = YES\nPATH"))
    done = measured_tracks.tracks(read(message), through)
    pd.testing.assert_frame_equal(done[tdm.COLUMNS], table[tdm.COLUMNS], check_exact=True)


def test_rates_go_with_the_delay_that_changes(table, three_stations):
    rows = table[table["track"] == 1].assign(range_rate=0.0, corrected=False)
    rows = rows[rows["station"] == rows["station"].iloc[0]].reset_index(drop=True)
    station = replace(next(one for one in three_stations if one.name == rows["station"][0]), troposphere=1.0)
    by_air = measured_tracks._by_air(rows, station)
    walked = np.cumsum(0.5 * (by_air["range_rate"][1:] + by_air["range_rate"][:-1]) * np.diff(rows["t"]))
    np.testing.assert_allclose(walked[-1], by_air["range"][-1] - by_air["range"][0], rtol=0.2)


def test_ranges_without_elevations_tell_no_air(message, three_stations):
    message.write_text(
        "\n".join(line for line in message.read_text().splitlines() if not line.startswith("ANGLE_2 ="))
    )
    through = [replace(station, troposphere=1.0) for station in three_stations]
    with pytest.raises(InputError, match="expected elevations with ranges, as"):
        measured_tracks.tracks(read(message), through)


def test_a_station_set_is_chosen_from_the_files(table, message, three_stations):
    one = measured_tracks.tracks(read(message), three_stations[:1])
    assert set(one["station"]) == {"eglin"}
    assert one["track"].tolist() == pd.factorize(one["track"])[0].tolist()
    assert len(one) == (table["station"] == "eglin").sum()
    with pytest.raises(InputError, match="expected measurements by other, got none"):
        measured_tracks.tracks(read(message), [replace(three_stations[0], name="other")])


def without(path, *keys):
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(line for line in lines if not line.startswith(keys)))


def test_without_ids_a_track_is_a_run_without_a_long_gap(message, three_stations):
    without(message, "TRACK_ID")
    found = measured_tracks.tracks(read(message), three_stations)
    begins, ends = (found.groupby("track")["t"].agg(which).to_numpy() for which in ("min", "max"))
    assert (begins[1:] - ends[:-1] > measured_tracks.LONGEST_GAP).all()
    inside = found.groupby("track")["t"].diff().max()
    assert inside <= measured_tracks.LONGEST_GAP


def test_tracks_that_overlap_are_one(table, tmp_path, three_stations):
    """As where two files hold what was measured at one time, each with ids of its own."""
    paths = [tmp_path / "even.tdm", tmp_path / "odd.tdm"]
    for k, path in enumerate(paths):
        tdm.write(path, table.iloc[k::2].assign(track=table["track"] + 5 * k), epoch=EPOCH, rso="iss")
    found = measured_tracks.tracks(read(*paths), three_stations)
    pd.testing.assert_frame_equal(found[tdm.COLUMNS], table[tdm.COLUMNS], check_exact=True)


def test_an_id_for_all_of_a_day_does_not_make_one_track_of_it(message, three_stations):
    text = message.read_text()
    message.write_text(
        "\n".join("TRACK_ID = x" if "TRACK_ID" in line else line for line in text.splitlines())
    )
    assert measured_tracks.tracks(read(message), three_stations)["track"].nunique() > 3


def edited(path, edit, pattern):
    """Edit the value of all data lines that begin with a regular expression."""
    lines = path.read_text().splitlines()
    for k, line in enumerate(lines):
        if re.match(pattern, line):
            head, value = line.rsplit(" ", 1)
            lines[k] = f"{head} {float(edit(float(value)))!r}"
    path.write_text("\n".join(lines))


def refusal(path, known=None, duration=A_DAY):
    with pytest.raises(InputError) as error:
        measured_tracks.check(read(path), known or stations(), epoch=EPOCH, duration=duration)
    return str(error.value)


def test_angles_in_radians_are_told(message):
    edited(message, np.radians, "ANGLE_[12]")
    assert refusal(message).startswith(f"{message}: line 21: expected angles in degrees, got none beyond 6.2")


def test_few_angles_in_radians_are_below_the_stations_limits(table, tmp_path):
    path = tmp_path / "few.tdm"
    tdm.write(path, table[table["station"] == "eglin"].iloc[:10], epoch=EPOCH, rso="iss")
    edited(path, np.radians, "ANGLE_[12]")
    assert "expected elevation of 1 to 90 deg, as eglin sees, got 0.0" in refusal(path)


@pytest.mark.parametrize(("factor", "said"), refusals("units_of_ranges"))
def test_ranges_in_other_units_are_told(message, factor, said):
    edited(message, lambda value: factor * value, "RANGE = ")
    assert f"{message}: " in refusal(message)
    assert said in refusal(message)


def test_a_station_that_no_sheet_has_is_told(message):
    message.write_text(message.read_text().replace("= clear", "= Atlantis-1", 1))
    text = refusal(message)
    assert "expected a station of eglin, clear, kaena, got Atlantis-1" in text
    line = int(text.split("line ")[1].split(":")[0])
    assert message.read_text().splitlines()[line - 1].startswith("ANGLE_1")


def test_stations_may_be_spelt_otherwise(table, message, three_stations):
    message.write_text(message.read_text().replace("= clear", "= CLEAR").replace("= eglin", "= EGL-IN"))
    assert len(measured_tracks.tracks(read(message), three_stations)) == len(table)


def test_times_outside_of_the_run_are_told(message):
    assert "expected a time within the run, 2016-09-28T12:09:45 and 0.1 days, got one +0" in refusal(
        message, duration=0.1 * DAY
    )


def test_a_measurement_twice_is_told(message):
    with pytest.raises(InputError, match="expected one measurement by kaena at a time, got a second one"):
        measured_tracks.check(read(message, message), stations(), epoch=EPOCH, duration=A_DAY)


OTHERS = "expected other values than those of .*iss.tdm, line [0-9]+, got"
CLOSE = "expected no time so close to that of .*iss.tdm, line [0-9]+, .*got one 0.001 s later: is a file"


@pytest.mark.parametrize(
    ("later", "farther", "said"), [(1e-3, 0.0, OTHERS), (3600.0, 0.0, OTHERS), (1e-3, 1e-3, CLOSE)]
)
def test_a_copy_with_other_times_is_told(table, message, tmp_path, later, farther, said):
    copy = tmp_path / "copy.tdm"
    shifted = table.assign(t=table["t"] + later, range=table["range"] + farther)
    tdm.write(copy, shifted, epoch=EPOCH, rso="iss")
    with pytest.raises(InputError, match=f"copy.tdm: line [0-9]+: {said}"):
        measured_tracks.check(read(message, copy), stations(), epoch=EPOCH, duration=2 * A_DAY)
