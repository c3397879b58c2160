"""SINEX: where stations are, and what is malformed, by file and line."""

import numpy as np
import pandas as pd
import pytest
from support import edited, refusal, refusals

from opml.base.errors import InputError
from opml.catalog.fit.laser_ranges import Sites
from opml.interop import sinex

COORDINATES = """\
%=SNX 2.01 JCT 20:119:43200 JCT 79:215:00000 20:119:43200 C 01338 2 X V
+SOLUTION/EPOCHS
*Code PT SOLN T Data_start__ Data_end____ Mean_epoch__
 7090  A    1 C 83:011:58876 30:000:00000 99:007:13417
 7237  A    2 C 08:076:21179 00:000:00000 09:254:68392
-SOLUTION/EPOCHS
+SOLUTION/ESTIMATE
*INDEX TYPE__ CODE PT SOLN _REF_EPOCH__ UNIT S __ESTIMATED VALUE____ _STD_DEV___
     1 STAX   7090  A    1 10:001:00000 m    2 -.238900643600000E+07 0.46577E-02
     2 STAY   7090  A    1 10:001:00000 m    2 0.504332935400000E+07 0.29116E-02
     3 STAZ   7090  A    1 10:001:00000 m    2 -.307852414500000E+07 0.45078E-02
     4 VELX   7090  A    1 10:001:00000 m/y  2 -.478000000000000E-01 0.48416E-04
     5 VELY   7090  A    1 10:001:00000 m/y  2 0.900000000000000E-02 0.55060E-04
     6 VELZ   7090  A    1 10:001:00000 m/y  2 0.510000000000000E-01 0.44195E-04
-SOLUTION/ESTIMATE
%ENDSNX
"""
ECCENTRICITIES = """\
%=SNX 2.02 JCT 20:111:61200 JCT 68:041:00000 20:111:61200 L 00549 0 X
+SITE/ECCENTRICITY
*SITE PT SOLN T DATA_START__ DATA_END____ UNE UP______ NORTH___ EAST____        CDP-SOD_
 7090  A    1 L 10:196:00000 14:079:86399 UNE   3.1820  -0.0068   0.0164        70900513
 7300  A    1 L 89:010:00000 00:000:00000 UNE  -0.6140-516.4230-565.4650        73001701
-SITE/ECCENTRICITY
%ENDSNX
"""


def written(tmp_path, text):
    path = tmp_path / "stations.snx"
    path.write_text(text)
    return path


def test_coordinates_are_read(tmp_path):
    [row] = sinex.read_coordinates(written(tmp_path, COORDINATES)).to_dict("records")
    assert row["station"] == "7090"
    assert row["begin"] == pd.Timestamp("1983-01-11 16:21:16")
    assert row["reference"] == pd.Timestamp("2010-01-01")
    assert (row["x"], row["y"], row["z"]) == (-2389006.436, 5043329.354, -3078524.145)
    assert row["vz"] * 365.25 * 86400.0 == pytest.approx(0.051)


def test_eccentricities_are_read_where_their_numbers_touch(tmp_path):
    table = sinex.read_eccentricities(written(tmp_path, ECCENTRICITIES))
    assert table["system"].tolist() == ["0513", "1701"]
    expected = [[3.182, -0.0068, 0.0164], [-0.614, -516.423, -565.465]]
    np.testing.assert_array_equal(table[["up", "north", "east"]], expected)
    assert table["end"].isna().tolist() == [False, True]


@pytest.mark.parametrize(("read", "old", "new", "message"), refusals("sinex"))
def test_what_is_malformed_is_named_by_file_and_line(tmp_path, read, old, new, message):
    text = COORDINATES if read == "read_coordinates" else ECCENTRICITIES
    path = edited(written(tmp_path, text), old, new)
    assert refusal(getattr(sinex, read), path).startswith(f"{path}: {message}")


def test_points_of_a_site_are_told_apart(tmp_path):
    lines = COORDINATES.splitlines(keepends=True)
    second = [line.replace(" A    1", " B    1").replace("-.2389006", "-.2389106") for line in lines[8:14]]
    path = written(tmp_path, "".join([*lines[:14], *second, *lines[14:]]))
    table = sinex.read_coordinates(path)
    assert dict(zip(table["point"], table["x"], strict=True)) == {"A": -2389006.436, "B": -2389106.436}
    sites = Sites(table, sinex.read_eccentricities(written(tmp_path, ECCENTRICITIES)))
    with pytest.raises(InputError, match=r"^station 7090: expected one point of its site, got A and B"):
        sites.position("7090", "0513", pd.Timestamp("2012-01-01"))
