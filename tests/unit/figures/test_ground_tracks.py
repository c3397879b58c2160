"""The world map: points below an orbit, circles of visibility, lines that leave the map."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import EARTH, RADAR

from opml.base.constants import DAY, WGS84_A
from opml.base.errors import InputError
from opml.figures import ground_tracks, style


@pytest.fixture
def truth():
    t = np.arange(0.0, 2 * DAY, 60.0)
    angle, radius = 2 * np.pi * t / 5400.0, WGS84_A + 400e3
    return pd.DataFrame({"t": t, "x": radius * np.cos(angle), "y": 0.0, "z": radius * np.sin(angle)})


def orbit_of(truth):
    return ground_tracks.ObservedOrbit(truth, EARTH, [RADAR])


def test_points_below_a_polar_orbit(truth):
    _, latitude, height = ground_tracks.geodetic_places(orbit_of(truth).itrf(truth.iloc[:90]))
    assert latitude.max() == pytest.approx(90.0, abs=4.0)
    assert height.min() == pytest.approx(400e3, abs=100.0)  # above the equator
    assert height.max() == pytest.approx(421.4e3, abs=100.0)  # above the poles, where the Earth is flatter


def test_a_circle_ends_at_the_horizon_or_at_the_longest_range():
    angle = ground_tracks.sight_angle(RADAR, 400e3)
    assert angle == pytest.approx(np.arccos(WGS84_A / (WGS84_A + 400e3)))
    near = ground_tracks.sight_angle(replace(RADAR, max_range=500e3), 400e3)
    chord = WGS84_A**2 + (WGS84_A + 400e3) ** 2 - 2 * WGS84_A * (WGS84_A + 400e3) * np.cos(near)
    assert np.sqrt(chord) == pytest.approx(500e3)
    high = ground_tracks.sight_angle(replace(RADAR, min_elevation=np.radians(30.0)), 400e3)
    assert np.degrees(high) == pytest.approx(5.4, abs=0.2)


def test_a_circle_is_as_far_from_its_station_everywhere():
    for latitude in (0.0, 64.3, -88.0):
        station = replace(RADAR, latitude=np.radians(latitude))
        longitude, place = map(np.radians, ground_tracks.circle(station, 0.3))
        cosine = np.sin(station.latitude) * np.sin(place) + np.cos(station.latitude) * np.cos(place) * np.cos(
            longitude - station.longitude
        )
        np.testing.assert_allclose(np.arccos(cosine), 0.3, atol=1e-9)


def test_the_outlines_of_land_lie_on_the_map():
    outlines = ground_tracks.outlines()
    assert len(outlines) > 50
    points = np.vstack(outlines)
    assert np.abs(points[:, 0]).max() <= 180.0
    assert np.abs(points[:, 1]).max() <= 90.0


EPOCH = "2020-02-29T06:00:00"


def test_the_map_shows_the_day_what_was_tracked_and_the_stations(truth, tmp_path):
    tracking = pd.DataFrame({"t": truth["t"].iloc[1440 + 10 : 1440 + 20]})
    figure = ground_tracks.world(orbit_of(truth), tracking, first_day=1.0, epoch=EPOCH, note="iss by radar")
    labels = {line.get_label(): line for line in figure.axes[0].lines}
    assert {"ground track", "tracked", "Radar"} <= set(labels)
    assert np.isfinite(labels["tracked"].get_ydata()).sum() == 10
    note = figure.legends[0].get_title().get_text()
    assert "iss by radar; 24 h from 2020-03-01 06:00 UTC (day 1); circles: in sight at" in note
    again = ground_tracks.world(orbit_of(truth), tracking, first_day=1.0, epoch=EPOCH, note="iss by radar")
    style.save(figure, tmp_path / "a.pdf", tmp_path / "a.png")
    style.save(again, tmp_path / "b.pdf", tmp_path / "b.png")
    for kind in ("pdf", "png"):
        assert (tmp_path / f"a.{kind}").read_bytes() == (tmp_path / f"b.{kind}").read_bytes()
    with pytest.raises(InputError, match="expected epochs of day 5, got none"):
        ground_tracks.world(orbit_of(truth), tracking, first_day=5.0, epoch=EPOCH)


def test_a_line_goes_to_the_edge_of_the_map_and_on_from_the_other():
    longitude, latitude = ground_tracks.split_line(
        np.array([170.0, 178.0, -174.0]), np.array([0.0, 8.0, 16.0])
    )
    assert longitude == pytest.approx([170.0, 178.0, 180.0, np.nan, -180.0, -174.0], nan_ok=True)
    assert latitude == pytest.approx([0.0, 8.0, 10.0, np.nan, 10.0, 16.0], nan_ok=True)
