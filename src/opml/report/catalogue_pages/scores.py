"""The report of a catalogue: what correctors leave of SGP4's errors, test by test."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from opml.element_sets.corrector_scores import ALL, LEVEL
from opml.element_sets.features import BANDS
from opml.report import texts
from opml.report.document import Block, items
from opml.report.results import rounded_cell


def document(
    scores: pd.DataFrame, seasons: Mapping[str, Mapping[str, Sequence[str]]], trained_on: Mapping[str, str]
) -> list[Block]:
    """Return the document.

    scores: `catalogue_scores`
    seasons: by test, the dates under `train` and `test`
    trained_on: by test, the population of the training
    """
    rows = [_cells(row) for row in _ordered(scores).to_dict("records")]
    return [
        *texts.blocks("scores.head"),
        items(_season(name, dates, trained_on[name]) for name, dates in seasons.items()),
        *texts.blocks("scores.scores", rows, level=LEVEL),
    ]


def _season(name: str, dates: Mapping[str, Sequence[str]], population: str) -> str:
    (first, last), (begin, end) = dates["train"], dates["test"]
    return f"**{name}**: learned from {population}, {first} to {last}; judged from {begin} to {end}"


def _ordered(scores: pd.DataFrame) -> pd.DataFrame:
    """Return the scores by test, in their order, band and lead, learners below each other."""
    place = pd.Categorical(scores["test"], categories=scores["test"].unique())
    return scores.assign(place=place.codes).sort_values(["place", "band", "lead"], kind="stable")


def band_name(band: int) -> str:
    """Return the heights of a band in words."""
    return "all" if band == ALL else f"{BANDS[band] / 1e3:g}-{BANDS[band + 1] / 1e3:g}"


def _cells(row: Mapping[str, Any]) -> list[str]:
    return [
        row["test"],
        band_name(row["band"]),
        str(row["lead"]),
        f"`{row['learner']}`",
        *(str(row[name]) for name in ("predictions", "objects", "weeks")),
        f"{row['by_orbits']:.0f}",
        f"{row['sgp4_median']:.0f} / {row['sgp4_p95']:.0f}",
        *(f"{row[f'{model}_median']:.0f} / {row[f'{model}_p95']:.0f}" for model in ("scaled", "learned")),
        f"{_with_interval(row, 'improved')} / {row['improved_p95']:.0f}",
        f"{row['unchanged']:.0f}",
        " / ".join(f"{row[f'{model}_p_ml']:.0f}" for model in ("scaled", "learned", "improved")),
        " / ".join(rounded_cell(row[name]) for name in ("coverage", "improved_coverage", "worst_week")),
    ]


def _with_interval(row: Mapping[str, Any], name: str) -> str:
    return f"{row[f'{name}_median']:.0f} ({row[f'{name}_low']:.0f} to {row[f'{name}_high']:.0f})"
