"""What sets of past weeks tell is kept for some days: mornings with it are those without, to the bit."""

import numpy as np
import pandas as pd
import pytest
import sinking_histories
from publisher import published
from support import EPOCH
from weather_files import other_after

from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets.inside import inside_now, kept_calibrations
from opml.interop.element_sets.burns_in_sets import KnownSet

BEGIN = np.floor(epochs.mjd(EPOCH))


@pytest.fixture(scope="module")
def sets(forces, truth):
    return [(day, published(forces, truth, day)) for day in np.arange(0.0, 15.0)]


def morning(sets, day, kept, weather="OBSERVED"):
    """The orbit inside the sets known on a morning, and its prediction."""
    date = f"{epochs.calendar(BEGIN + day)}T06:00:00"
    since = DAY * (epochs.mjd(EPOCH) - epochs.mjd(date))
    public = [KnownSet(since + DAY * at, since + DAY * at, one) for at, one in sets]
    known = [one for one in public if one.made <= 0.0]
    now = inside_now.find(known, date=date, forces=inside_now.forces_on(date, weather), kept=kept)
    return now, now.predict(2.0)[1]


def test_mornings_with_kept_calibrations_are_those_without_to_the_bit(sets, tmp_path, monkeypatch):
    sinking_histories.seek_coarsely(monkeypatch.setattr)
    path, number = tmp_path / "kept.npz", sets[0][1].satnum
    first = next(day for day in range(11, 15) if (BEGIN + day - number) % inside_now.CALIBRATED_EVERY == 0)
    kept = {}
    morning(sets, first, kept)
    assert [key[:10] for key in kept] == [epochs.calendar(BEGIN + first)]
    kept_calibrations.write(path, kept)
    kept = kept_calibrations.read(path)
    with monkeypatch.context() as patch:
        patch.setattr(inside_now, "daily_orbits", None)  # no orbits are sought but the newest
        now, flown = morning(sets, first + 1, kept)
    scratch, again = morning(sets, first + 1, {})
    np.testing.assert_array_equal(flown, again)
    errors = (one.calibration.errors for one in (now, scratch))
    pd.testing.assert_frame_equal(*errors, check_exact=True)
    assert now.calibration[:4] == scratch.calibration[:4]
    written = path.read_bytes()
    kept_calibrations.write(path, kept)
    assert path.read_bytes() == written
    # Weather that was revised before a calibration makes it anew; that of later days does not.
    today = BEGIN + first
    for since, count in ((today + 0.1, 1), (today - 4.0, 2)):
        morning(sets, first + 1, kept, other_after(tmp_path / f"{count}.csv", since))
        assert len(kept) == count


def test_calibrations_that_hold_no_longer_go(sets, tmp_path):
    calibration = inside_now.Calibration(
        inside_now.centred(DAY),
        25.0,
        5.0,
        0.5,
        pd.DataFrame(np.ones((2, 11)), columns=inside_now.past_orbits.ERRORS),
    )
    path = tmp_path / "kept.npz"
    kept_calibrations.write(path, {})
    assert not path.exists()
    kept_calibrations.write(
        path, dict.fromkeys(["2016-10-05 a", "2016-10-02 b", "2016-10-01 c"], calibration)
    )
    kept = kept_calibrations.read(path)
    assert [*kept] == ["2016-10-02 b", "2016-10-05 a"]
    assert kept["2016-10-02 b"][:4] == calibration[:4]
    pd.testing.assert_frame_equal(kept["2016-10-02 b"].errors, calibration.errors)


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04", b"no numbers"], ids=["empty", "torn", "other"])
def test_a_damaged_file_is_told_and_made_anew(tmp_path, damage, caplog):
    path = tmp_path / "kept.npz"
    assert kept_calibrations.read(path) == {}
    assert not caplog.records
    path.write_bytes(damage)
    assert kept_calibrations.read(path) == {}
    assert "kept.npz: damaged" in caplog.text
