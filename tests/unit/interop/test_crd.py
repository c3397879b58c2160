"""CRD: normal points come in as they stand, and what is malformed is named by file and line."""

import numpy as np
import pytest
from support import refusal, refusals

from opml.base.errors import InputError
from opml.interop import crd

EPOCH = "2016-02-13T00:00:00"
PASS = """\
h1 CRD  1 2016  2 13 14
h2 YARL       7090  5 13 3
h3 lageos2     9207002 5986    22195 0 1
h4  1 2016  2 13 23 42 16 2016  2 14  0  6 46  0 0 0 0 1 0 2 0
c0 0  532.000 std la1 mcp ti1
c1 0 la1 Nd:Yag     532.00       5.00     100.00  150.0 15.00    1
40 49336.4 0 std -1 -1 -1.0 105320.0 -17.0 27.0 -1.0 -1.0 -1.0 2 2 0
20 85382.401  983.70 301.40  24. 0
11 85382.4     0.04 std 2  120.0     94   57.0   0.183  -0.536      -1.0  15.67 0
20 182.0  983.90 301.20  26. 0
11 82.2     0.05 std 2  120.0     39   65.0   0.083  -0.301      -1.0   6.50 0
50 std  61.0  0.1 0.2 -1.0 0
h8
"""
EARLIER = PASS.replace("2016  2 13 23 42 16", "2016  2 13 10 42 16").replace("YARL       7090", "MATM 7941")
EARLIER = EARLIER.replace("853", "403").replace("11 82.2", "11 40582.2").replace("20 182.0", "20 40682.0")


def written(tmp_path, *texts):
    path = tmp_path / "points.crd"
    path.write_text("".join(texts) + "h9\n")
    return path


def test_points_are_read(tmp_path):
    table = crd.read([written(tmp_path, PASS, EARLIER)], epoch=EPOCH, satellite="lageos2")
    assert table["track"].tolist() == [0, 0, 1, 1]
    assert table["station"].tolist() == ["7941", "7941", "7090", "7090"]
    assert set(table["system"]) == {"0513"}
    late = table[table["track"] == 1]
    np.testing.assert_allclose(late["t"], [85382.44, 86482.25], atol=1e-9)
    assert late["flight"].tolist() == [0.04, 0.05]
    np.testing.assert_allclose(late["wavelength"], 532e-9)
    share = (86400.0 + 82.2 - 85382.401) / (86400.0 + 182.0 - 85382.401)
    np.testing.assert_allclose(late["pressure"], [98370.0, 98370.0 + 20.0 * share])
    np.testing.assert_allclose(late["humidity"], [0.24, 0.24 + 0.02 * share])
    assert late["line"].tolist() == [9, 11]
    np.testing.assert_allclose(late["scatter"], [57e-12 * 299792458.0 / 2, 65e-12 * 299792458.0 / 2])


def test_passes_that_are_poor_are_left_out_and_told(tmp_path, caplog):
    poor = EARLIER.replace("0 1 0 2 0\nc0", "0 1 0 2 2\nc0")
    path = written(tmp_path, PASS, poor)
    assert set(crd.read([path], epoch=EPOCH)["station"]) == {"7090"}
    assert f"{path}: line 17: a pass of poor quality is ignored" in caplog.messages


@pytest.mark.parametrize("nothing", ["-1.0", "na", "0"])
def test_a_point_may_tell_no_scatter(tmp_path, nothing):
    table = crd.read([written(tmp_path, PASS.replace("57.0", nothing))], epoch=EPOCH)
    assert table["scatter"].isna().tolist() == [True, False]


def test_a_pass_that_was_released_again_counts_once(tmp_path):
    again = PASS.replace("46  0 0 0", "46  1 0 0").replace("0.04 std", "0.041 std")
    for texts in ((PASS, again, EARLIER), (again, EARLIER, PASS)):
        table = crd.read([written(tmp_path, *texts)], epoch=EPOCH)
        assert table["track"].tolist() == [0, 0, 1, 1]
        assert table["flight"].tolist()[2:] == [0.041, 0.05]
        assert "release" not in table
    with pytest.raises(InputError, match="line 4: expected a finite number, got none"):
        crd.read([written(tmp_path, PASS.replace("46  0 0 0", "46  none 0 0"))], epoch=EPOCH)


def test_points_of_two_satellites_do_not_mix(tmp_path):
    other = EARLIER.replace("lageos2     9207002 5986    22195", "lageos1 7603901 1155 8820")
    for texts in ([PASS + other], [PASS, other]):
        paths = []
        for number, text in enumerate(texts):
            paths.append(tmp_path / f"{number}.crd")
            paths[-1].write_text(text + "h9\n")
        assert "expected satellite lageos2, got lageos1" in refusal(crd.read, paths, epoch=EPOCH)


@pytest.mark.parametrize(("event", "later"), [("0", 0.0), ("1", 0.5), ("2", 1.0)])
def test_the_light_is_received_after_the_event(tmp_path, event, later):
    path = written(tmp_path, PASS.replace("std 2  120.0", f"std {event}  120.0"))
    t = crd.read([path], epoch=EPOCH)["t"]
    np.testing.assert_allclose(t, [85382.4 + 0.04 * later, 86482.2 + 0.05 * later], atol=1e-9)


@pytest.mark.parametrize(("old", "new", "message"), refusals("crd"))
def test_what_is_malformed_is_named_by_file_and_line(tmp_path, old, new, message):
    assert old in PASS
    text = PASS.replace(old, new, 1)
    text = "\n".join(line.partition("#")[0] for line in text.splitlines()) + "\n"
    path = written(tmp_path, text)
    assert refusal(crd.read, [path], epoch=EPOCH).startswith(f"{path}: {message}")


def test_no_weather_no_points_and_another_satellite_are_refused(tmp_path):
    dry = "".join(line for line in PASS.splitlines(keepends=True) if not line.startswith("20 "))
    for text, options, message in (
        (dry, {}, "line 8: expected a record 20 of the weather in the pass, got none"),
        ("", {}, "expected normal points, got none"),
        (PASS, {"satellite": "lageos1"}, "expected satellite lageos1, got lageos2"),
    ):
        with pytest.raises(InputError, match=message):
            crd.read([written(tmp_path, text)], epoch=EPOCH, **options)


def test_a_cut_file_is_noticed(tmp_path):
    path = tmp_path / "cut.crd"
    for size in range(0, len(PASS) - 5, 41):
        path.write_text(PASS[:size])
        assert "expected" in refusal(crd.read, [path], epoch=EPOCH)
