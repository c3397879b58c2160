"""Mean elements of an ephemeris: those that it was flown with, as OMM and TLE that others read."""

import numpy as np
import pytest
from sgp4 import omm as others
from sgp4.api import Satrec
from support import EPOCH
from test_element_fits import MADE

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.interop.element_sets import element_fits, mean_elements, omm, tle
from opml.interop.element_sets.element_set import elements_epoch, satellite
from opml.interop.ephemeris import Ephemeris
from opml.interop.object_ids import ObjectId

AT = 1234.567891
"""Time of the elements [s], not one that a TLE can tell."""


def flown(days=1.0, behind=0.0):
    """An ephemeris that SGP4 flies, half of it so many metres behind."""
    t = AT + np.arange(0.0, days * DAY, 300.0)
    states = mean_elements.states(satellite("2016-09-28T12:30:19.567891", MADE), epoch=EPOCH, t=t)
    states[len(t) // 2 :, :3] -= behind * states[len(t) // 2 :, 3:] / 7.6e3
    return Ephemeris("made", t, states)


@pytest.fixture(scope="module")
def ephemeris():
    return flown()


@pytest.fixture(scope="module")
def fitted(ephemeris):
    return element_fits.fit_ephemeris(ephemeris, epoch=EPOCH)


def farthest(found, ephemeris):
    """Largest distance of SGP4 from the ephemeris [m]."""
    states = mean_elements.states(found, epoch=EPOCH, t=ephemeris.t)
    return np.linalg.norm(states - ephemeris.states, axis=1).max()


def test_an_omm_is_read_by_us_and_by_the_package_sgp4(ephemeris, fitted, tmp_path):
    path = tmp_path / "made.omm"
    omm.write(path, fitted, identity=ObjectId("made", number=123456789), epoch=EPOCH, comment="far off")
    assert path.read_text().splitlines()[1] == "COMMENT far off"
    (ours,) = mean_elements.read_sets(path)
    assert (ours.number, ours.created) == (123456789, elements_epoch(fitted))
    assert farthest(ours.satellite, ephemeris) < 1.0
    theirs = Satrec()
    pairs = [line.split(" = ") for line in path.read_text().splitlines() if " = " in line]
    others.initialize(theirs, dict(pairs) | {"NORAD_CAT_ID": "5"})
    assert farthest(theirs, ephemeris) < 1.0


def test_a_tle_begins_at_a_time_that_it_can_tell(ephemeris, fitted, tmp_path):
    tle.write(tmp_path / "made.tle", fitted, ObjectId("made", "1998-067A", 25544))
    (ours,) = mean_elements.read_sets(tmp_path / "made.tle")
    assert (ours.number, ours.designator) == (25544, "98067A")
    assert elements_epoch(ours.satellite) == elements_epoch(fitted) == "2016-09-28T12:30:19.567584"
    assert farthest(ours.satellite, ephemeris) < 15.0  # what the digits of the angles leave
    theirs = Satrec.twoline2rv(*(tmp_path / "made.tle").read_text().splitlines())
    assert farthest(theirs, ephemeris) < 15.0


def test_the_residual_is_told_and_logged(caplog):
    caplog.set_level("INFO")
    bent = flown(days=2.0, behind=300.0)
    found = element_fits.fit_ephemeris(bent, epoch=EPOCH)
    sentence = element_fits.residual(found, bent, epoch=EPOCH)
    assert sentence in caplog.messages
    states = mean_elements.states(found, epoch=EPOCH, t=bent.t)
    apart = np.linalg.norm(states[:, :3] - bent.states[:, :3], axis=1)
    rms = np.sqrt(np.mean(apart**2))
    assert sentence == f"SGP4 is {rms:.0f} m rms from the ephemeris of 2 days, {apart.max():.0f} m at most."
    assert 20.0 < rms < 150.0


def test_elements_that_decay_within_the_ephemeris_are_refused():
    dying = satellite("2016-09-28T12:30:00", [16.4 * 2 * np.pi / 1440, *MADE[1:6], 0.5])
    with pytest.raises(InputError, match=r"mean elements: expected an orbit for \d+ s, got one that ends"):
        element_fits.residual(dying, flown(2.0), epoch=EPOCH)


def test_an_object_that_nothing_tells_has_the_number_of_tests(fitted, tmp_path):
    omm.write(tmp_path / "made.omm", fitted, identity=ObjectId("made"), epoch=EPOCH, comment="")
    tle.write(tmp_path / "made.tle", fitted, ObjectId("made"))
    found = [mean_elements.read_sets(tmp_path / name)[0] for name in ("made.omm", "made.tle")]
    assert [(one.number, one.designator) for one in found] == [(99999, "made"), (99999, "")]
