"""Mean elements fitted to an orbit: those that the orbit was flown with, written as TLEs, by the command."""

import numpy as np
import pandas as pd
import pytest

from opml import cli
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.interop import oem
from opml.interop.element_sets import element_fits, histories, mean_elements, tle
from opml.interop.element_sets.element_set import elements_epoch, satellite
from opml.tables import STATE

EPOCH = "2024-01-01T00:00:00"
MADE = [15.5 * 2 * np.pi / 1440, 5e-4, *np.deg2rad([51.64, 210.5, 40.25, 319.8]), 3e-4]
"""Elements on the second day at noon, with the mean motion in rad/min."""

NAMES = ["no_kozai", "ecco", "inclo", "nodeo", "argpo", "mo", "bstar"]


def flown(days, step=element_fits.CADENCE):
    """The table of an orbit that SGP4 flies with these elements."""
    t = np.arange(0.0, days * DAY + 1.0, step)
    states = mean_elements.states(satellite("2024-01-02T12:00:00", MADE), epoch=EPOCH, t=t)
    return pd.DataFrame({"t": t, **dict(zip(STATE, states.T, strict=True))})


def plan(**changed):
    return element_fits.SetPlan(
        **{"every": DAY, "span": 1.5 * DAY, "noise": 0.0, "seed": 1, "number": 5} | changed
    )


def elements(one):
    return [getattr(one, name) for name in NAMES]


def test_the_elements_of_an_orbit_are_found_again():
    first, second = element_fits.from_orbit(flown(2.5), plan(), epoch=EPOCH)
    np.testing.assert_allclose(elements(first.satellite), MADE, rtol=1e-6, atol=1e-8)
    assert first.rms < 0.05
    assert second.rms < 0.5  # SGP4 does not carry its own mean elements from one epoch to another
    assert elements_epoch(second.satellite) == "2024-01-03T12:00:00.000000"


def test_an_hour_of_positions_is_enough():
    (found,) = element_fits.from_orbit(flown(1.0 / 24.0), plan(span=HOUR), epoch=EPOCH)
    assert found.rms < 0.5


def test_noise_stays_in_what_the_fit_leaves():
    plans = [plan(noise=30.0, seed=seed) for seed in (1, 1, 2)]
    (first,), (same,), (other,) = (element_fits.from_orbit(flown(1.6), one, epoch=EPOCH) for one in plans)
    assert first.rms == pytest.approx(30.0 * np.sqrt(3.0), rel=0.05)
    assert elements(first.satellite) == elements(same.satellite) != elements(other.satellite)


def test_an_epoch_without_positions_before_it_has_no_set(caplog):
    orbit = flown(3.5)
    orbit = orbit[(orbit["t"] < 1.6 * DAY) | (orbit["t"] > 2.4 * DAY)]
    fits = list(element_fits.from_orbit(orbit, plan(), epoch=EPOCH))
    assert [elements_epoch(one.satellite)[8:13] for one in fits] == ["02T12", "04T12"]
    assert "no set at 216000 s: too few positions before it" in caplog.text


@pytest.mark.parametrize(
    ("speed", "message"),
    [(12.0, "an eccentricity below 1, got 1.5"), (2.0, "an orbit that SGP4 can fly about 2024-01-0")],
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


@pytest.fixture
def orbit_file(tmp_path):
    path = tmp_path / "orbit.oem"
    oem.write(path, oem.truth_segments(flown(0.5, 60.0), rso="made"), epoch=EPOCH)
    return path


def test_the_command_prints_sets_and_what_they_leave(orbit_file, tmp_path, capsys):
    options = ["--every", "3", "--span", "0.25", "--noise", "10", "--number", "100001"]
    assert cli.main(["elements", str(orbit_file), *options]) == 0
    printed = capsys.readouterr()
    assert printed.err.startswith("opml: 3 sets, 17 m rms from the positions, at most 1")
    (tmp_path / "sets.tle").write_text(printed.out)
    sets = histories.read([tmp_path / "sets.tle"], epoch=EPOCH).sets
    assert sets["number"].tolist() == [100001] * 3
    np.testing.assert_allclose(sets["t"], [6 * HOUR, 9 * HOUR, 12 * HOUR], atol=1e-3)
    orbit = flown(0.5)
    states = histories.predict(sets, epoch=EPOCH, known=DAY, t=orbit["t"].to_numpy())
    apart = np.linalg.norm(states[:, :3] - orbit[STATE[:3]].to_numpy(), axis=1)
    assert apart[len(apart) // 2 :].max() < 100.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--every", "0"], "every: expected 120 s or more, got 0 s"),
        (["--span", "nan"], "span: expected 3600 s or more, got nan s"),
        (["--noise", "-1"], "noise: expected a standard deviation [m], got -1"),
        (["--span", "0.25", "--number", "340000"], "number: expected one of a TLE, 1 to 339999, got 340000"),
        (["--span", "3"], "{path}: expected an orbit without gaps for longer than 3 days, got 0.5 days"),
        (["--satellite", "x"], "{path}: expected satellite x, got "),
    ],
)
def test_the_command_tells_what_is_wrong_in_one_line(orbit_file, capsys, options, message):
    assert cli.main(["elements", str(orbit_file), *options]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(f"opml: {message.format(path=orbit_file)}")
    assert printed.err.count("\n") == 1
