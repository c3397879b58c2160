"""Mean elements fitted to positions: those that the orbit was flown with; and their lines as a TLE."""

import numpy as np
import pytest

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.interop.element_sets import element_fits, mean_elements, tle
from opml.interop.element_sets.element_set import elements_epoch, satellite

EPOCH = "2024-01-01T00:00:00"
MADE = [15.5 * 2 * np.pi / 1440, 5e-4, *np.deg2rad([51.64, 210.5, 40.25, 319.8]), 3e-4]
"""Elements on the second day at noon, with the mean motion in rad/min."""

NAMES = ["no_kozai", "ecco", "inclo", "nodeo", "argpo", "mo", "bstar"]


def elements(one):
    return [getattr(one, name) for name in NAMES]


def test_the_elements_of_an_orbit_are_found_again():
    t = np.arange(0.0, 1.5 * DAY, 120.0)
    states = mean_elements.states(satellite("2024-01-02T12:00:00", MADE), epoch=EPOCH, t=t)
    positions, velocities = element_fits.in_teme(states, EPOCH, t)
    last = np.concatenate([positions[-1], velocities[-1]])
    found = element_fits.fit(t, positions, at=t[-1], known=last, epoch=EPOCH)
    flown = mean_elements.states(found, epoch=EPOCH, t=t)
    assert np.sqrt(np.mean(np.sum((flown - states)[:, :3] ** 2, axis=1))) < 0.5
    assert elements_epoch(found) == "2024-01-02T11:58:00.000000"


@pytest.mark.parametrize(
    ("speed", "message"),
    [(12.0, "an eccentricity below 1, got 1.5"), (2.0, "an orbit that SGP4 can propagate about 2024-01-0")],
)
def test_what_is_no_orbit_of_a_satellite_has_no_set(speed, message):
    last = np.array([7000.0, 0.0, 0.0, 0.0, speed, 1.0])
    t = np.arange(0.0, 3600.0, 600.0)
    positions = last[:3] + (t - t[-1])[:, None] * last[3:]
    with pytest.raises(InputError, match=f"mean elements: expected {message}"):
        element_fits.fit(t, positions, at=t[-1], known=last, epoch=EPOCH)


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"bstar": -2.5e-5},
        {"bstar": 0.0},
        {"bstar": 3e-12},
        {"bstar": 0.12345},
        {"bstar": 9.99999e-5},
        {"nodeo": np.deg2rad(359.99999)},
        {"nodeo": 0.0},
        {"ecco": 0.7, "no_kozai": 2.0 * 2 * np.pi / 1440},
    ],
)
@pytest.mark.parametrize("number", [7, 99999, 100000, 339999])
def test_lines_of_a_set_are_read_as_the_set(tmp_path, changed, number):
    made = [changed.get(name, value) for name, value in zip(NAMES, MADE, strict=True)]
    path = tmp_path / "set.tle"
    path.write_text("\n".join(tle.lines(satellite("2024-02-29T23:59:59.5", made), number)))
    (found,) = mean_elements.read_sets(path)
    assert found.number == number
    assert elements_epoch(found.satellite)[:20] == "2024-02-29T23:59:59."
    apart = np.array(elements(found.satellite)) - made
    apart[3] = (apart[3] + np.pi) % (2 * np.pi) - np.pi
    digits = [1e-10, 1e-7, *[2e-6] * 4, 1e-5 * abs(made[6]) + 1e-10]
    assert (np.abs(apart) < digits).all()
