"""Write the package's two tables of solar activity afresh from downloads.

    python -m validation.reference.activity_tables <SW-All.csv> <MSAFE bulletin>...

The first is CelesTrak's file in CSSI's format, gzipped or not; all bulletins there are follow, in any order.
src/opml/data/README.md says which files the tables were last made of.
"""

import re
import sys
from pathlib import Path

import pandas as pd

from opml.base.files import replacing
from opml.environment import solar_activity, space_weather

FIRST_DAY = "1995-12-29"
"""The flux of the day before and an hour of margin: from here on, a run may start on 1996-01-01."""
MEASURED = ("OBS", "INT")
"""CSSI's types of flux that are no prediction: observed, or interpolated where a day was missed."""
AHEAD = 40
"""Days that the centred 81-day mean looks ahead."""

DAYS = ["DATE", *space_weather.KP, "F10.7_OBS", "F10.7_DATA_TYPE", "F10.7_OBS_CENTER81"]
MONTHS = ("JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV", "DEC")
# Looser than the package's reader: some bulletins up to 2010 have page footers, a month twice, Ap below 0.
ROW = re.compile(r"^\s*(\d{4})\.\d+\s+([A-Z]{3})((?:\s+-?\d+\.\d+){6})\s*$", re.MULTILINE)


def observed(source):
    """Text of `space_weather.csv`: the days whose figures, the 81-day mean among them, are all measured."""
    full = pd.read_csv(source, dtype=str)
    days = full[full["F10.7_DATA_TYPE"].isin(MEASURED) & (full["DATE"] >= FIRST_DAY)].iloc[:-AHEAD]
    first, last = days["DATE"].iloc[[0, -1]]
    return (
        f"# Observed Kp (times ten) and F10.7 [sfu], {first} to {last}: "
        "CelesTrak's SW-All.csv in CSSI's format, fewer columns.\n"
        "# Kp: GFZ Potsdam, CC BY 4.0, doi:10.5880/Kp.0001. "
        "F10.7: Natural Resources Canada and DRAO, Penticton.\n"
    ) + days.to_csv(columns=DAYS, index=False, lineterminator="\n")


def msafe(bulletins):
    """Text of `msafe.tsv`: each month from the newest of the bulletins (their texts) that list it.

    A bulletin's age is told by its first month, half a year before its issue, as Orekit does.
    """
    by_age = sorted(map(_rows, bulletins), key=min)
    months = {month: figures for rows in by_age for month, figures in rows.items()}
    return (
        "# Monthly estimates of the 13-month smoothed solar flux F10.7 [sfu] and geomagnetic index Ap "
        "at the 95, 50 and 5 %\n"
        "# percentiles: MSAFE, NASA Marshall Space Flight Center. "
        "Each month is from the newest bulletin that lists it;\n"
        f"# from {min(by_age[-1])} on, that is one and the same bulletin.\n"
        "month\tf107_95\tf107_50\tf107_5\tap_95\tap_50\tap_5\n"
    ) + "".join("\t".join([month, *months[month]]) + "\n" for month in sorted(months))


def _rows(text):
    """Figures of a bulletin by month."""
    return {
        f"{year}-{MONTHS.index(name) + 1:02d}": figures.split() for year, name, figures in ROW.findall(text)
    }


def _write(name, text):
    """Write a packaged table that its reader takes."""
    path = solar_activity.resolve(name)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")
        solar_activity.reach(temporary)


def main(weather, bulletins):
    _write("OBSERVED", observed(weather))
    _write("MSAFE", msafe(Path(path).read_text(encoding="utf-8") for path in bulletins))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
