"""Earth orientation against Orekit's rotation and against ERFA's own assembly."""

from pathlib import Path

import astropy_iers_data
import erfa
import numpy as np
import pandas as pd
import pytest
from support import EXCERPTS, refusal

from opml.base import epochs
from opml.base.constants import DAY, EARTH_RATE, HOUR
from opml.base.errors import InputError
from opml.environment import earth_orientation, nodes

EPOCH = "2016-09-28T12:09:45"
REFERENCE = EXCERPTS / "earth_orientation.csv"


def rotation(table):
    """GCRF to ITRF, shape (n, 3, 3): W(xp, yp, s') R3(ERA) Q(X, Y, s), IERS Conventions 2010, eq. 5.1."""
    tt = epochs.tt(EPOCH, table["t"])
    celestial = erfa.c2ixys(table["x_cip"], table["y_cip"], table["s_cio"])
    era = (table["era_offset"] + EARTH_RATE * table["t"]).to_numpy()
    return erfa.c2tcio(celestial, era, erfa.pom00(table["x_pole"], table["y_pole"], erfa.sp00(*tt)))


def angle(a, b):
    """Angle [rad] between rotations, shape (n,); from the antisymmetric part, exact for small ones."""
    d = a @ np.swapaxes(b, -1, -2)
    axis = np.stack([d[:, 1, 2] - d[:, 2, 1], d[:, 2, 0] - d[:, 0, 2], d[:, 0, 1] - d[:, 1, 0]])
    return np.linalg.norm(axis / 2.0, axis=0)


def test_rotation_is_orekits_to_a_nanoradian():
    # Measured on 110 points: 1.6e-10 rad at most (1 mm at an ISS), all of it the daily pole's interpolation;
    # about the axis of rotation 1e-13 rad.
    reference = pd.read_csv(REFERENCE, comment="#")
    matrices = reference.drop(columns="t").to_numpy().reshape(-1, 3, 3)
    ours = rotation(earth_orientation.tabulate(EPOCH, reference["t"].to_numpy()))
    assert angle(ours, matrices).max() < 3e-10


def test_bulletin_b_goes_before_bulletin_a(tmp_path):
    # Digits of the file itself for 2016-10-10: A and B differ in the fifth.
    line = next(x for x in Path(astropy_iers_data.IERS_A_FILE).read_text().splitlines() if "57671.00" in x)
    both, rapid = tmp_path / "both", tmp_path / "rapid"
    both.write_text(line + "\n")
    rapid.write_text(line[:134] + "\n")
    arcsecond = np.pi / 648000.0
    assert earth_orientation.read_finals2000a(both)["x_pole"][0] == float(line[134:144]) * arcsecond
    assert earth_orientation.read_finals2000a(rapid)["x_pole"][0] == float(line[18:27]) * arcsecond


def test_rotation_angle_is_smooth_through_a_leap_second():
    t = nodes("2016-12-31T00:00:00", 2 * DAY)
    offset = earth_orientation.tabulate("2016-12-31T00:00:00", t)["era_offset"]
    # A day longer than 86400 s by 1.5 ms turns 1e-7 rad less; a second would be 7e-5 rad.
    assert np.abs(np.diff(offset)).max() < 2e-8


def test_dates_outside_the_bulletin_are_refused_with_its_span():
    with pytest.raises(InputError, match=r"expected dates from 1973-01-0.*got 1970-01-01"):
        earth_orientation.tabulate("1970-01-01T00:00:00", np.array([0.0]))
    with pytest.raises(InputError, match="got 2016-09-28 to 2071-"):
        earth_orientation.tabulate(EPOCH, np.array([0.0, 55 * 365.25 * DAY]))


def test_unreadable_bulletins_are_refused(tmp_path):
    path = tmp_path / "finals"
    assert "no such file" in refusal(earth_orientation.read_finals2000a, path)
    path.write_text("nothing of the kind\n")
    assert "got none" in refusal(earth_orientation.read_finals2000a, path)
    line = next(x for x in Path(astropy_iers_data.IERS_A_FILE).read_text().splitlines() if "57671.00" in x)
    path.write_text(line.replace(line[134:144], "   0.2x419"))
    assert "line 1: expected figures" in refusal(earth_orientation.read_finals2000a, path)


def test_another_bulletin_is_read_in_place_of_the_packaged_one(tmp_path):
    t = np.array([0.0, HOUR])
    lines = Path(astropy_iers_data.IERS_A_FILE).read_text().splitlines()
    shifted = [line[:134] + "  0.300000" + line[144:] for line in lines]
    path = tmp_path / "finals2000A.all"
    path.write_text("\n".join(shifted))
    table = earth_orientation.tabulate(EPOCH, t, bulletin=path)
    packaged = earth_orientation.tabulate(EPOCH, t)
    np.testing.assert_allclose(table["x_pole"], 0.3 * np.pi / 648000.0, rtol=1e-12)
    np.testing.assert_array_equal(table["y_pole"], packaged["y_pole"])


def test_a_later_bulletin_is_told_by_the_days_of_the_run(tmp_path):
    lines = Path(astropy_iers_data.IERS_A_FILE).read_text().splitlines(keepends=True)
    run = {"epoch": "2016-10-05T00:00:00", "duration_days": 3.0}

    def digest(mjd):
        """The digest where UT1 of a day is another."""
        changed = [
            f"{line[:58]} 0.1234567{line[68:154]}{'':11}{line[165:]}" if f"{mjd}.00" in line[7:15] else line
            for line in lines
        ]
        (tmp_path / f"{mjd}.all").write_text("".join(changed))
        return earth_orientation.bulletin_digest(**run, bulletin=tmp_path / f"{mjd}.all")

    same = earth_orientation.bulletin_digest(**run)
    assert digest(57650) == digest(57700) == same
    assert digest(57667) != same
