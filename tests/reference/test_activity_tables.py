"""The package's tables of solar activity are what a program of validation makes of the downloads."""

import pandas as pd
from support import shared

from opml.environment import solar_activity
from validation.reference.activity_tables import DAYS, msafe, observed

TITLE = "  TABLE 3 ESTIMATES OF 13-MONTH SMOOTH SOLAR ACTIVITY FOR\n\n"


def bulletin(*rows):
    """A bulletin that gives each month the same F10.7."""
    return TITLE + "".join(f" {row} {flux}  80.0  70.0  12.0  11.0  {low}\n" for row, flux, low in rows)


OLD = bulletin(
    ("2016.9170   DEC", 91.0, 10.0), ("2017.0003   JAN", 92.0, 10.0), ("2017.0837   FEB", 93.0, -0.1)
)
NEW = bulletin(("2017.0837   FEB", 83.0, 10.0), ("2017.1670   MAR", 84.0, 10.0))


def test_each_month_is_of_the_newest_bulletin_that_lists_it_and_an_older_one_bridges_a_gap():
    rows = [line.split("\t")[:2] for line in msafe([NEW, OLD]).splitlines() if line[0].isdigit()]
    assert rows == [["2016-12", "91.0"], ["2017-01", "92.0"], ["2017-02", "83.0"], ["2017-03", "84.0"]]


def test_page_footers_of_old_bulletins_are_passed_over():
    assert msafe([NEW + "\n   NASA/MSFC/EL23     Page 5 of 9     ENCLOSURE 3\n", OLD]) == msafe([NEW, OLD])


def test_days_whose_flux_or_mean_is_predicted_are_left_out(tmp_path):
    days = pd.DataFrame("1", index=range(60), columns=[*DAYS, "ISN"])
    days["DATE"] = pd.date_range("1995-12-27", periods=60).strftime("%Y-%m-%d")
    days["F10.7_DATA_TYPE"] = ["OBS"] * 30 + ["INT"] + ["OBS"] * 19 + ["PRD"] * 9 + ["PRM"]
    days.to_csv(tmp_path / "SW-All.csv", index=False)
    rows = [line.split(",") for line in observed(tmp_path / "SW-All.csv").splitlines() if line[0] != "#"]
    assert rows[0] == DAYS
    # The last observed day is 1996-02-14; its mean reaches 40 days further.
    assert [row[0] for row in rows[1:]] == [f"1995-12-{day}" for day in (29, 30, 31)] + [
        f"1996-01-{day:02d}" for day in range(1, 6)
    ]


def test_the_packaged_weather_is_made_of_celestraks_file():
    text = observed(shared("real/SW-All.csv.gz"))
    assert text == solar_activity.resolve("OBSERVED").read_text(encoding="utf-8")


def test_the_packaged_months_are_made_of_the_bulletins():
    paths = [*shared("orekit-data/MSAFE").glob("*.txt"), *shared("real/msafe").glob("*.txt")]
    made = msafe(path.read_text(encoding="utf-8") for path in paths).splitlines()
    packaged = solar_activity.resolve("MSAFE").read_text(encoding="utf-8").splitlines()
    # The bulletins here are those of 2016-01 to 2024-03, each the newest of the month half a year before it.
    made, packaged = ([x for x in table if "2015-07" <= x[:7] <= "2023-09"] for table in (made, packaged))
    assert len(made) == 99
    assert made == packaged
