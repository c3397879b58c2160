"""The report's section on stated uncertainty: shares of errors inside it, by the prediction's duration."""

from collections.abc import Iterator, Mapping, Sequence

import pandas as pd

from opml.base.constants import DAY
from opml.learning.judge import calibration
from opml.learning.judge.error_sizes import INSIDE
from opml.learning.judge.errors_by_duration import REACH_DAYS
from opml.learning.judge.model_choice import CHOSEN, Mornings
from opml.report import texts
from opml.report.document import Block
from opml.report.mornings import Dataset
from opml.report.results import NO_VALUE, length
from opml.tables import ELLIPSOID, PLANE, WHOLE

TITLE = "Are the covariances realistic?"

_QUANTITIES = ("e_x", "e_y", "e_z", PLANE, ELLIPSOID, WHOLE)

TOO_SHORT = "No morning had a past that was long enough to state a covariance from."

HOLDS = (0.85, 0.95)  # shares at which an ellipsoid of 90 % counts as true


def section(replays: Mapping[Dataset, Mornings], days: Sequence[float]) -> Iterator[Block]:
    """Yield the section, nothing where no morning was replayed.

    days: prediction durations that shares are stated at
    """
    if not replays:
        return
    yield from texts.blocks("uncertainty.section", title=TITLE, passes=calibration.PASSES)
    for (rso, stations), mornings in replays.items():
        tables = {CHOSEN: mornings.selected} | {f"`{name}`": table for name, table in mornings.tables.items()}
        shares = calibration.of_replays(tables, days=days)
        rows = [row for name in shares for row in _rows(name, tables[name], shares[name], days)]
        verdict = _verdict(mornings.selected, shares[CHOSEN], days) if CHOSEN in shares else TOO_SHORT
        yield from texts.blocks("uncertainty.dataset", rows, rso=rso, stations=stations, verdict=verdict)


def _verdict(selected: pd.DataFrame, shares: pd.DataFrame, days: Sequence[float]) -> str:
    ellipsoids = shares[shares["quantity"] == ELLIPSOID]
    held = {row["day"]: row["inside"] for row in ellipsoids.to_dict("records")}
    tested = calibration.goodness(selected, days=days).dropna(subset=["p"])
    return texts.sentences(
        "uncertainty.verdict",
        words=", ".join(f"{100.0 * share:.0f} % at {day:g} d" for day, share in held.items()),
        good=sum(HOLDS[0] <= share <= HOLDS[1] for share in held.values()),
        held=len(held),
        passed=int((tested["p"] >= calibration.PASSES).sum()),
        tested=len(tested),
        least=calibration.LEAST,
    )


def _rows(name: str, table: pd.DataFrame, shares: pd.DataFrame, days: Sequence[float]) -> Iterator[list[str]]:
    tested = calibration.goodness(table, days=days).set_index("day")
    for day, rows in shares.groupby("day"):
        near = (table["duration"] / DAY - day).abs() <= REACH_DAYS
        futures = length(table.loc[near, "weather_y"].median())
        p, score = tested.loc[day, "p"], tested.loc[day, "score"]
        yield [*_cells(name, day, rows), futures, NO_VALUE if pd.isna(p) else f"{p:.2f}", f"{score:.1f}"]


def _cells(name: str, day: float, shares: pd.DataFrame) -> list[str]:
    """Return name, duration, shares inside, and the deviation along-track, from one day's shares."""
    main = shares.set_index("quantity")
    inside = [
        f"{100.0 * main.loc[quantity, 'inside']:.0f}" if quantity in main.index else NO_VALUE
        for quantity in _QUANTITIES
    ]
    return [name, f"{day:g}", *inside, length(main.loc["e_y", "stated"] / INSIDE)]
