"""Solar activity against Orekit's, and bulletins that cannot be used."""

import gzip

import numpy as np
import pandas as pd
import pytest
from support import EXCERPTS, refusal, refusals, shared

from opml.base import epochs
from opml.base.errors import InputError
from opml.environment import solar_activity

EPOCH = "2016-09-28T12:09:45"
REFERENCE = EXCERPTS / "solar_activity.csv"
BULLETIN = """  TABLE 3 ESTIMATES OF 13-MONTH SMOOTH SOLAR ACTIVITY FOR
  BALANCE OF CYCLE 24 WITH A MEAN CYCLE GIVEN FOR CYCLE 25

    TIME         10.7 CM SOLAR FLUX   (F10.7)      GEOMAGNETIC INDEX   (Ap)
                         PERCENTILE                    PERCENTILE
                  95.0%       50%      5.0%     95.0%       50%      5.0%

 2016.9170   DEC    82.0      80.0      78.0      12.0      11.0      10.0
 2017.0003   JAN   104.0      90.5      77.0      16.0      12.0       8.0
 2017.0837   FEB    80.0      78.0      76.0      12.0      11.0      10.0

"""


@pytest.fixture
def bulletin(tmp_path):
    """Writes a bulletin's text and gives its path."""

    def write(text=BULLETIN):
        path = tmp_path / "jun2017f10.txt"
        path.write_text(text)
        return path

    return write


def read(path):
    return solar_activity.read(path, solar_activity.read_text(path))


def test_packaged_months_are_orekits_to_rounding():
    reference = pd.read_csv(REFERENCE, comment="#")
    ours = solar_activity.tabulate("MSAFE", EPOCH, reference["t"].to_numpy(), 50)
    pd.testing.assert_frame_equal(ours, reference, check_exact=False, rtol=1e-12)


def test_a_bulletin_is_read_by_month_and_percentile(bulletin):
    months = read(bulletin())
    assert months.index.tolist() == ["2016-12", "2017-01", "2017-02"]
    assert months.loc["2017-01"].tolist() == [104.0, 90.5, 77.0, 16.0, 12.0, 8.0]
    january = np.array([epochs.seconds_between(EPOCH, "2017-01-01T00:00:00")])
    for percentile, f107, ap in [(95, 104.0, 16.0), (50, 90.5, 12.0), (5, 77.0, 8.0)]:
        row = solar_activity.tabulate(bulletin(), EPOCH, january, percentile).iloc[0]
        assert row["f107"] == row["f107_mean"] == f107
        assert row["kp_3h"] == row["kp_24h"] == 1.89 * np.arcsinh(0.154 * ap)


def test_flux_and_ap_change_linearly_between_months(bulletin):
    middle = np.array([epochs.seconds_between(EPOCH, "2017-01-16T12:00:00")])
    row = solar_activity.tabulate(bulletin(), EPOCH, middle, 50).iloc[0]
    assert row["f107"] == pytest.approx((90.5 + 78.0) / 2, rel=1e-12)
    # Ap, not Kp, is what changes linearly.
    assert row["kp_3h"] == pytest.approx(1.89 * np.arcsinh(0.154 * 11.5), rel=1e-12)


@pytest.mark.parametrize("folder", ["orekit-data/MSAFE", "real/msafe"])
def test_the_packaged_months_are_the_first_of_the_bulletins(folder):
    ours = read(solar_activity.resolve("MSAFE"))
    firsts = pd.concat([read(path).iloc[:1] for path in shared(folder).glob("*.txt")])
    assert len(firsts) >= 24
    pd.testing.assert_frame_equal(ours.loc[firsts.index], firsts, check_exact=True)


def test_the_packaged_months_reach_from_1998_to_2041_and_not_a_second_further():
    assert solar_activity.reach("MSAFE") == ("1998-09-01", "2041-10-01")
    ends = [epochs.seconds_between(EPOCH, f"{day}T00:00:00") for day in solar_activity.reach("MSAFE")]
    found = solar_activity.tabulate("MSAFE", EPOCH, np.array(ends), 50)
    assert found["f107"].tolist() == [127.7, 70.0]
    for beyond in (ends[0] - 1.0, ends[1] + 1.0):
        with pytest.raises(
            InputError, match=r"^msafe\.tsv: epoch: expected dates from 1998-09-01 to 2041-10-01"
        ):
            solar_activity.tabulate("MSAFE", EPOCH, np.array([0.0, beyond]), 50)


def test_a_leap_second_before_a_month_is_counted():
    # 1999-01-01 is 43201 s after noon of the day before.
    found = solar_activity.tabulate("MSAFE", "1998-12-31T12:00:00", np.array([43200.0, 43201.0]), 50)
    january = read(solar_activity.resolve("MSAFE")).loc["1999-01", "f107_50"]
    assert found["f107"].iloc[1] == january
    assert found["f107"].iloc[0] != january


@pytest.mark.parametrize("percentile", [40, "50", None])
def test_an_unknown_percentile_is_refused(percentile):
    with pytest.raises(InputError, match=r"^percentile: expected 95, 50 or 5, got"):
        solar_activity.tabulate("MSAFE", EPOCH, np.array([0.0]), percentile)


@pytest.mark.parametrize(("old", "new", "message"), refusals("solar_activity"))
def test_what_cannot_be_used_is_named_in_one_line(bulletin, old, new, message):
    assert f"jun2017f10.txt: {message}" in refusal(read, bulletin(BULLETIN.replace(old, new)))


def test_a_bulletin_without_months_is_refused(bulletin):
    with pytest.raises(InputError, match="expected at least two months, got 0"):
        read(bulletin(BULLETIN[: BULLETIN.index(" 2016.9170")]))


def test_a_malformed_row_of_the_packaged_table_is_refused(tmp_path):
    text = solar_activity.resolve("MSAFE").read_text()
    path = tmp_path / "own.tsv"
    path.write_text(text.replace("2016-10\t84.7", "2016-10\t"))
    assert "own.tsv: line 222: expected year, month and six figures" in refusal(read, path)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"absent\.txt: no such file"):
        read(tmp_path / "absent.txt")


def test_a_gzipped_file_is_read_and_a_broken_one_is_refused(tmp_path):
    content = solar_activity.resolve(solar_activity.OBSERVED).read_bytes()
    packed = gzip.compress(content, mtime=0)
    (tmp_path / "whole.gz").write_bytes(packed)
    (tmp_path / "half.gz").write_bytes(packed[: len(packed) // 2])

    assert solar_activity.read_text(tmp_path / "whole.gz") == content.decode()
    with pytest.raises(InputError, match=r"half\.gz: expected a table of solar activity \("):
        solar_activity.read_text(tmp_path / "half.gz")
