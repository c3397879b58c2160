"""The page of a prediction: what was used and why, errors to expect, passes."""

import math
from collections.abc import Iterator, Mapping, Sequence

import pandas as pd

from opml.element_sets.prediction import Prediction
from opml.element_sets.station_passes import LEVEL, Place
from opml.interop.predicted_orbit import UNKNOWABLE, PredictedOrbit
from opml.report import texts
from opml.report.document import Block, Picture, as_it_is
from opml.report.results import length, with_unit

_SECONDS, _DATE = len("2016-09-28T12:09:45"), len("2016-09-28T")

_TURNS = 24.0 * 60.0 / math.tau  # revolutions a day for each radian a minute


def document(
    prediction: PredictedOrbit, passes: Mapping[Place, pd.DataFrame], pictures: Sequence[Picture]
) -> list[Block]:
    """Return the page; passes: by place; pictures: errors over days, and the ground track."""
    rows = prediction.expected().dropna(axis="columns", how="all")
    return [
        "# " + as_it_is(f"{prediction.identity}: {prediction.days:g} days from {_z(prediction.date)}"),
        *([_in_short(rows)] if "along_track" in rows else []),
        *([f"So far: {prediction.past_in_words}."] if prediction.past_in_words else []),
        *_how(prediction),
        [*pictures],
        *(_expected(rows) if "along_track" in rows else []),
        f"One sigma each: {prediction.basis}; {UNKNOWABLE}.",
        *(block for where, rows in passes.items() for block in _passes(where, rows)),
    ]


def _in_short(rows: pd.DataFrame) -> str:
    later = rows[rows["lead"] > 0.0].to_dict("records")
    parts = (f"**{with_unit(row['along_track'])}** after {row['lead']:g} d" for row in later)
    return f"Expected error along the track, one sigma: {', '.join(parts)}."


def _how(prediction: PredictedOrbit) -> Iterator[Block]:
    used = {"way": prediction.way, "reason": prediction.reason}
    if not isinstance(prediction, Prediction):
        return texts.blocks("prediction_page.used", **used)
    how = dict(prediction.how)
    turns = {name: _TURNS * how.pop(name) for name in ("motion", "motion_before")}
    part = "inside" if prediction.model == "inside" else "improved"
    return texts.blocks(f"prediction_page.{part}", **used, **how | turns | {"height": how["height"] / 1e3})


def _expected(rows: pd.DataFrame) -> Iterator[Block]:
    names = {
        "along_track": "along track [m]",
        "radial": "radial [m]",
        "cross_track": "cross-track [m]",
        "sgp4_along_track": "SGP4 along track [m]",
    }
    shown = {name: words for name, words in names.items() if name in rows}
    cells = [[str(row["lead"]), *(length(row[name]) for name in shown)] for row in rows.to_dict("records")]
    return texts.blocks("prediction_page.expected", cells, names=texts.across(shown.values()))


def _passes(where: Place, rows: pd.DataFrame) -> Iterator[Block]:
    yield "## " + as_it_is(f"Passes over {where.name}")
    if rows.empty:
        yield "None."
        return
    cells = [
        [
            _z(row["rise"]),
            *(_z(row[name])[_DATE:] for name in ("highest", "set")),
            f"{row['elevation']:.0f}",
            f"{row['early_or_late']:.1f}" if math.isfinite(row["early_or_late"]) else "-",
        ]
        for row in rows.to_dict("records")
    ]
    yield from texts.blocks("prediction_page.passes", cells, level=100.0 * LEVEL)


def _z(time: str) -> str:
    return f"{time[:_SECONDS]}Z"
