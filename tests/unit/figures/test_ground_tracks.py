"""The world map: land, points below an orbit, lines that leave the map."""

import numpy as np
import pytest

from opml.base.constants import WGS84_A
from opml.figures import ground_tracks


def test_points_below_a_polar_orbit():
    angle, radius = np.linspace(0.0, 2.0 * np.pi, 90), WGS84_A + 400e3
    _, latitude, height = ground_tracks.geodetic_places(
        radius * np.column_stack([np.cos(angle), np.zeros(90), np.sin(angle)])
    )
    assert latitude.max() == pytest.approx(90.0, abs=4.0)
    assert height.min() == pytest.approx(400e3, abs=100.0)  # above the equator
    assert height.max() == pytest.approx(421.4e3, abs=100.0)  # above the poles, where the Earth is flatter


def test_the_outlines_of_land_lie_on_the_map():
    outlines = ground_tracks.outlines()
    assert len(outlines) > 50
    points = np.vstack(outlines)
    assert np.abs(points[:, 0]).max() <= 180.0
    assert np.abs(points[:, 1]).max() <= 90.0


def test_a_line_goes_to_the_edge_of_the_map_and_on_from_the_other():
    longitude, latitude = ground_tracks.split_line(
        np.array([170.0, 178.0, -174.0]), np.array([0.0, 8.0, 16.0])
    )
    assert longitude == pytest.approx([170.0, 178.0, 180.0, np.nan, -180.0, -174.0], nan_ok=True)
    assert latitude == pytest.approx([0.0, 8.0, 10.0, np.nan, 10.0, 16.0], nan_ok=True)
