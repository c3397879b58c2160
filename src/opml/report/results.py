"""Rows of the `metrics` table by the experiment that they belong to, and how their numbers are printed."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from opml.naming import Experiment

NONE = "-"
"""What stands in a cell that has no number."""


class Results:
    """P_ML and the like by experiment, from rows of the `metrics` table."""

    def __init__(self, metrics: pd.DataFrame) -> None:
        columns = ["rso", "stations", "train", "learner", "component", "target", "test"]
        self._rows = {tuple(row[name] for name in columns): row for row in metrics.to_dict("records")}

    def of(self, experiment: Experiment) -> Mapping[str, Any]:
        """Return the row of an experiment; KeyError where it did not run."""
        row: Mapping[str, Any] = self._rows[tuple(experiment.columns().values())]
        return row

    def p_ml(self, experiment: Experiment) -> float:
        """Return P_ML [%] of an experiment."""
        return float(self.of(experiment)["p_ml"])

    def extent(self, experiments: Sequence[Experiment]) -> tuple[float, float]:
        """Return the smallest and the largest P_ML [%] of experiments."""
        numbers = [self.p_ml(one) for one in experiments]
        return min(numbers), max(numbers)

    def with_interval(self, experiment: Experiment) -> str:
        """Return P_ML with its 5th and 95th percentile over resampled estimates, as a cell."""
        row = self.of(experiment)
        return f"{row['p_ml']:.1f} ({row['p_ml_low']:.1f} to {row['p_ml_high']:.1f})"


def length(value: float) -> str:
    """Return a length [m] as a cell: metres, below a hundred to three digits."""
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def percent(value: float | None) -> str:
    """Return a percentage as a cell."""
    return NONE if value is None else f"{value:.1f}"


def extent_cell(extent: tuple[float, float] | None) -> str:
    """Return a range of percentages as a cell."""
    return NONE if extent is None else f"{extent[0]:.1f} to {extent[1]:.1f}"
