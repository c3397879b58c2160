"""The figures of the orbit: which tracks are used, what is in sight, the elements, and stable bytes."""

import numpy as np
import pandas as pd
import pytest
from drawing import assert_inside
from matplotlib.colors import to_hex

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures import orbit, style
from opml.orbits.elements import cartesian_from_coe
from opml.tables import STATE

GM = 3.986004415e14
HOUR = 3600.0


@pytest.fixture
def tracking():
    # Tracks by hour of their start: 12 h before the estimate is still inside, a little more is not.
    starts = {0: -13.0, 1: -12.0, 2: -5.0, 3: 0.0, 4: 3.0}
    rows = [
        {
            "track": track,
            "t": 100 * HOUR + start * HOUR + 20.0 * k,
            "station": "clear" if track % 2 else "eglin",
        }
        for track, start in starts.items()
        for k in range(1 if track == 2 else 10)
    ]
    return pd.DataFrame(rows)


@pytest.fixture
def truth():
    # A day of a circular orbit around the poles, one revolution in 90 minutes.
    t = np.arange(0.0, DAY + 1.0, 20.0)
    a = (GM * (5400.0 / (2 * np.pi)) ** 2) ** (1 / 3)
    coe = np.zeros((len(t), 6))
    coe[:, 0] = a
    coe[:, 1] = 1e-3
    coe[:, 2] = np.radians(90.0)
    coe[:, 3] = np.radians(40.0)
    coe[:, 4] = np.radians(1.0 - 2.0 * t / DAY) % (2 * np.pi)  # passes 0 after half a day
    coe[:, 5] = 2 * np.pi * t / 5400.0
    return pd.DataFrame(cartesian_from_coe(coe, GM), columns=list(STATE)).assign(t=t)


def test_tracks_of_the_window(tracking):
    figure = orbit.estimation_window(tracking, track=3, window_hours=12.0)
    assert figure.get_suptitle().startswith(
        "An estimate uses the 3 tracks that begin within 12 h before it\n"
    )
    axes = figure.axes[0]
    drawn = sorted((box for bars in axes.containers for box in bars), key=lambda box: box.get_x())
    boxes = {round(box.get_x(), 6): to_hex(box.get_facecolor()) for box in drawn}
    used, unused = style.HIGHLIGHT.lower(), style.TRACK_COLOR.lower()
    assert boxes == {-13.0: unused, -12.0: used, -5.0: used, 0.0: used, 3.0: unused}
    widths = [box.get_width() for box in drawn]
    assert widths == pytest.approx([0.05, 0.05, 0.0, 0.05, 0.05])  # ten measurements, 20 s apart; one alone
    lanes = [box.get_y() + box.get_height() / 2 for box in drawn]
    assert lanes == pytest.approx([0, 1, 0, 1, 0])
    assert [label.get_text() for label in axes.get_yticklabels()] == ["Eglin", "Clear"]
    dots = axes.get_lines()[0]
    assert list(dots.get_xdata()) == pytest.approx([-13.0, -12.0, -5.0, 0.0, 3.0])


def test_window_is_shaded_and_labelled(tracking):
    figure = orbit.estimation_window(tracking, track=3, window_hours=12.0)
    window = figure.axes[0].patches[0]
    assert (window.get_x(), window.get_width()) == (-12.0, 12.0)
    assert figure.axes[0].get_xlabel() == "time since $t_i$ = 4.167 d [h]"
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["estimation window, 12 h", "epoch of an estimate", "track used", "track not used"]


def test_unknown_track(tracking):
    with pytest.raises(InputError, match="expected a track of the table, got 9"):
        orbit.estimation_window(tracking, track=9, window_hours=12.0)


def test_arcs_from_red_to_blue(truth, tracking):
    figure = orbit.orbit_3d(truth, tracking.assign(t=truth["t"].iloc[:41].to_numpy()))
    assert figure.get_suptitle().startswith("0.9 % of the orbit is observed\n")
    arcs = figure.axes[0].collections[1]
    days = arcs.get_array()
    assert arcs.get_clim() == (0.0, 1.0)
    assert days.min() == 0.0
    assert days.max() < 1.0
    red, _, blue, _ = arcs.get_cmap()(0.0)
    assert red > 2 * blue
    red, _, blue, _ = arcs.get_cmap()(1.0)
    assert blue > 2 * red
    assert figure.axes[1].get_xlabel() == "time [d]"
    assert figure.axes[0].get_zlabel() == "$z$ [1000 km]"


def test_observed_points_are_those_tracked_and_in_sight(truth, tracking):
    chosen = truth.iloc[:270]  # a revolution: some of it behind the Earth
    figure = orbit.orbit_3d(truth, pd.DataFrame({"t": chosen["t"]}))
    drawn = np.stack(figure.axes[0].collections[2]._offsets3d, axis=-1)
    positions = chosen[["x", "y", "z"]].to_numpy() / 1e6
    assert 135 < len(drawn) < 270
    distance = np.linalg.norm(drawn[:, None] - positions[None], axis=-1)
    assert distance.min(axis=1).max() < 1e-9


def test_the_earth_hides_what_is_behind_it():
    elevation, azimuth = np.radians([orbit.ELEVATION, orbit.AZIMUTH])
    viewer = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    aside = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    points = np.array([8.0 * viewer, -8.0 * viewer, -8.0 * viewer + 7.0 * aside, -8.0 * viewer + 6.0 * aside])
    assert orbit._is_visible(points).tolist() == [True, False, True, False]


def test_revolutions_are_counted(truth):
    turns = orbit._revolutions(truth[["x", "y", "z"]].to_numpy())
    assert turns[270] == pytest.approx(1.0, abs=1e-4)  # 5400 s
    assert turns[-1] == pytest.approx(16.0, abs=1e-3)
    with pytest.raises(InputError, match=r"at least one revolution, got 0\.99"):
        orbit.orbit_3d(truth.iloc[:269], pd.DataFrame({"t": [0.0]}))


def test_elements_and_their_zoom(truth):
    figure = orbit.orbital_elements(
        truth, gm=GM, zoom_days=(0.25, 0.5), elements=("a", "e", "i", "argp", "raan", "nu")
    )
    left, right = figure.axes[::2], figure.axes[1::2]
    assert [axes.get_ylabel() for axes in left] == [
        "$a$ [km]",
        "$e$ [$10^{-3}$]",
        "$i$ [deg]",
        r"$\omega$ [deg]",
        r"$\Omega$ [deg]",
        r"$\nu$ [deg]",
    ]
    assert figure.get_suptitle().startswith(
        "The mean semi-major axis changes from 6653 to 6653 km in 1 days\n"
    )
    drawn = [axes.get_lines()[0].get_ydata() for axes in left]
    assert drawn[0] == pytest.approx(6652.556, abs=0.01)  # Kepler's third law, 5400 s
    assert drawn[1] == pytest.approx(1.0)
    assert drawn[2] == pytest.approx(90.0)
    assert drawn[3] == pytest.approx(40.0, abs=1e-6)
    assert len(drawn[0]) == 16  # a mean for each whole revolution
    assert [len(axes.collections) for axes in left] == [1, 1, 1, 0, 0, 0]  # ranges, but of angles that turn
    zoomed = right[0].get_lines()[0].get_xdata()
    assert (zoomed[0], zoomed[-1], len(zoomed)) == (0.25, 0.5, 1081)
    assert left[-1].get_xlabel() == right[-1].get_xlabel() == "time [d]"


def test_an_angle_breaks_where_it_passes_a_turn(truth):
    figure = orbit.orbital_elements(truth, gm=GM, zoom_days=(0.4, 0.6), elements=("raan",))
    raan = figure.axes[0].get_lines()[0].get_ydata()
    assert np.isnan(raan).sum() == 1
    assert raan[0] == pytest.approx(1.0)
    assert raan[-1] == pytest.approx(359.0)
    assert len(figure.axes) == 2


def test_a_zoom_outside(truth):
    with pytest.raises(InputError, match=r"expected epochs within days 25 to 25\.4, got none"):
        orbit.orbital_elements(truth, gm=GM, zoom_days=(25.0, 25.4))


@pytest.mark.slow
def test_stable_bytes_and_nothing_clipped(truth, tracking, tmp_path):
    def figures():
        yield orbit.estimation_window(tracking, track=3, window_hours=12.0)
        yield orbit.orbit_3d(truth, pd.DataFrame({"t": truth["t"].iloc[100:140]}))
        yield orbit.orbital_elements(truth, gm=GM, zoom_days=(0.25, 0.5))

    for k, (one, two) in enumerate(zip(figures(), figures(), strict=True)):
        files = [tmp_path / f"{k}{run}.{kind}" for run in "ab" for kind in ("pdf", "png")]
        style.save(one, *files[:2])
        style.save(two, *files[2:])
        assert files[0].read_bytes() == files[2].read_bytes()
        assert files[1].read_bytes() == files[3].read_bytes()
        assert_inside(one)
