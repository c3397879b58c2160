"""Learns how far SGP4 from one element set is usually off, and prints how much its intervals hold:

    python -m validation.set_errors LEARNED... -- JUDGED... > src/opml/data/set_errors.csv

Each argument is a file of element sets, a season of its own. One half of the objects of LEARNED is learned
from; the other half, and all objects of JUDGED, judge on the standard error stream, beside a table of root
mean squares by height and day. Seasons count alike.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import minimize

from opml.base.seeds import derive
from opml.element_sets import catalogue, corrector
from opml.interop.element_sets import sgp4_errors
from opml.interop.element_sets.sgp4_errors import AXES, HEIGHTS
from opml.orbits.elements import bent_rsw
from opml.orbits.rsw_covariance import half_width

LEADS = np.array([0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
"""Days after the epoch of a set whose next later sets judge it."""

MOST = 30_000
"""Sets of a season, drawn at random."""

LEVEL = 0.9
SEED = 42
CLIPPED = 3.0  # sigmas that count in a pair
LARGEST = 5.0  # sigmas that an error counts at most in a log score
_REACH = 7.6
_COLUMNS = ["number", "day", "tau", "band", "drag", *AXES]
_STARTS = ((4.0, 3.0, -2.0), (5.0, 4.0, -4.0))
_HEAD = """# How far SGP4 from one public element set is off: variance = constant^2 + (rate t)^2 + (drag d)^2,
# t days from the epoch, d the set's drag displacement [m]; python -m validation.set_errors"""


def errors(path: str) -> pd.DataFrame:
    """Return the errors of the sets of a file in RSW [m], with their drag displacement [m]."""
    sets = catalogue.read([path], latency=0.0).daily()
    number, t = sets.table["number"].to_numpy(), sets.table["t"].to_numpy()
    drawn = derive(SEED, Path(path).name).permutation(len(t))[:MOST]
    rows = [row for k in np.sort(drawn) for row in _errors_of_set(sets, int(k), number, t)]
    table = pd.DataFrame(rows, columns=_COLUMNS).dropna().astype({"number": int, "band": int})
    return table.assign(season=Path(path).name.partition(".")[0])


def _errors_of_set(sets: catalogue.ElementCatalogue, k: int, number: np.ndarray, t: np.ndarray) -> list[list]:
    satellite = sets.satellites[k]
    if not sgp4_errors.are_known(satellite) or satellite.bstar <= 0.0:
        return []
    later = np.arange(k + 1, np.searchsorted(number, number[k], side="right"))
    later = later[t[later] - t[k] <= _REACH]
    if not len(later):
        return []
    judges = later[np.unique(np.minimum(np.searchsorted(t[later], t[k] + LEADS), len(later) - 1))]
    days = t[judges] - t[k]
    flown = sgp4_errors.sgp4_states(satellite, days)
    truth = np.vstack([sgp4_errors.sgp4_states(sets.satellites[j], np.zeros(1)) for j in judges])
    band = int(np.searchsorted(HEIGHTS, sets.table["height"].iat[k], side="right")) - 1
    drag = sgp4_errors.drag_displacement(satellite, days)
    return [
        [number[k], int(t[k]), *row]
        for row in np.column_stack([days, np.full(len(days), band), drag, bent_rsw(flown[:, :3], truth)])
    ]


def sigma(numbers: np.ndarray, table: pd.DataFrame) -> np.ndarray:
    """Return the law's standard deviations [m] of rows."""
    grown = np.stack([np.ones(len(table)), table["tau"], table["drag"]])
    return np.sqrt(numbers**2 @ grown**2)


def learned(table: pd.DataFrame, axis: str) -> np.ndarray:
    """Return a, b, c by quantile regression of ln|error|, each season of the same weight."""
    weight = 1.0 / table.groupby("season")["tau"].transform("size").to_numpy()
    error = np.log(np.maximum(table[axis].abs().to_numpy(), 1.0) / half_width(LEVEL))

    def loss(logarithms: np.ndarray) -> float:
        beyond = error - np.log(sigma(np.exp(logarithms), table))
        return float(np.average(np.maximum(LEVEL * beyond, (LEVEL - 1.0) * beyond), weights=weight))

    found = (minimize(loss, start, method="Nelder-Mead", options={"maxiter": 600}) for start in _STARTS)
    return np.exp(min(found, key=lambda one: one.fun).x)


def law(table: pd.DataFrame) -> pd.DataFrame:
    """Return the numbers by band and axis."""
    rows = [
        (axis, HEIGHTS[band] / 1e3, *learned(own, axis))
        for band, own in table.groupby("band")
        for axis in AXES
    ]
    return pd.DataFrame(rows, columns=["axis", "height_km", "constant_m", "rate_m_per_d", "drag"])


def judge(table: pd.DataFrame, seen: pd.DataFrame, numbers: np.ndarray) -> None:
    """Print shares inside the intervals of 90 % by season, band and day, and log scores beside a table's."""
    day = {"day": table["tau"].round().clip(1, 7)}
    squares = seen.assign(day=seen["tau"].round().clip(1, 7)).groupby(["band", "day"])
    for k, axis in enumerate(AXES):
        size = np.empty(len(table))
        for band, members in table.groupby("band").indices.items():
            size[members] = sigma(numbers[band, k], table.iloc[members])
        rms = squares[axis].apply(lambda one: np.sqrt((one**2).mean())).rename("rms")
        beside = table.assign(**day).join(rms, on=["band", "day"])["rms"].to_numpy()
        own = table.assign(**day, inside=100.0 * (table[axis].abs() <= half_width(LEVEL) * size))
        scores = [log_score(table[axis].to_numpy(), one) for one in (size, beside)]
        print(f"{axis}: log score {scores[0]:.2f}, of a table {scores[1]:.2f}", file=sys.stderr)
        for key in ("season", "band"):
            shares = own.groupby([key, "day"])["inside"].mean().unstack()
            print(shares.round().to_string(), file=sys.stderr)


def log_score(error: np.ndarray, sigma: np.ndarray) -> float:
    """Return the mean of ln(sigma / 1 m) + (error / sigma)^2 / 2, the less the better (Good 1952).

    No error counts more than LARGEST sigma: it is a burn.
    """
    return float(np.nanmean(np.log(sigma) + 0.5 * np.minimum((error / sigma) ** 2, LARGEST**2)))


def common_share(table: pd.DataFrame, numbers: np.ndarray) -> pd.Series:
    """Return the share of the variance by drag that objects have in common along the track, by days ahead.

    By least squares on all pairs of objects of a band and a day; errors count in the law's sigmas.
    """
    along = numbers[table["band"], 1]
    size = np.sqrt(
        np.sum(
            (along * np.column_stack([np.ones(len(table)), *table[["tau", "drag"]].T.values])) ** 2, axis=1
        )
    )
    part = along[:, 2] * table["drag"] / size
    error = np.clip(table["s"] / size, -CLIPPED, CLIPPED) * part
    days = table.assign(ahead=table["tau"].round().clip(1, 7), error=error, part=part**2)
    days = days.drop_duplicates(["season", "number", "day", "ahead"])
    groups = days.assign(own=days["error"] ** 2, square=days["part"] ** 2).groupby(
        ["season", "day", "band", "ahead"]
    )
    summed = groups[["error", "part", "own", "square"]].sum()
    pairs = pd.DataFrame(
        {"errors": summed["error"] ** 2 - summed["own"], "parts": summed["part"] ** 2 - summed["square"]}
    )
    by_lead = pairs.groupby("ahead").sum()
    return by_lead["errors"] / by_lead["parts"]


def main(arguments: Sequence[str]) -> None:
    """Print the law."""
    split = arguments.index("--")
    teachers, others = (pd.concat(map(errors, part)) for part in (arguments[:split], arguments[split + 1 :]))
    half = corrector.drawn_halves(teachers["number"].to_numpy(), "set errors", seed=SEED)
    seen, unseen = teachers[half == 0], pd.concat([teachers[half == 1], others]).reset_index(drop=True)
    table = law(seen).round({"constant_m": 1, "rate_m_per_d": 1, "drag": 5})
    print(_HEAD)
    table.to_csv(sys.stdout, index=False)
    numbers = table[["constant_m", "rate_m_per_d", "drag"]].to_numpy().reshape(-1, len(AXES), 3)
    judge(unseen, seen, numbers)
    print(common_share(unseen, numbers).round(2).to_string(), file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
