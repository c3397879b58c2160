"""Rows of the `metrics` table by their experiment, and numbers as cells of a report's tables."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from opml.naming import Experiment

NO_VALUE = "-"  # the cell of a number that is not there


class Results:
    """Measures of experiments, P_ML among them, from rows of the `metrics` table."""

    def __init__(self, metrics: pd.DataFrame) -> None:
        columns = ["rso", "stations", "train", "learner", "component", "target", "test"]
        self._rows = {tuple(row[name] for name in columns): row for row in metrics.to_dict("records")}

    def row(self, experiment: Experiment) -> Mapping[str, Any]:
        """Return the row of an experiment; KeyError where it did not run."""
        return self._rows[tuple(experiment.columns().values())]

    def p_ml(self, experiment: Experiment) -> float:
        """Return P_ML [%] of an experiment."""
        return float(self.row(experiment)["p_ml"])

    def extent(self, experiments: Sequence[Experiment]) -> tuple[float, float]:
        """Return the smallest and the largest P_ML [%] of experiments."""
        numbers = [self.p_ml(experiment) for experiment in experiments]
        return min(numbers), max(numbers)

    def p_ml_cell(self, experiment: Experiment) -> str:
        """Return P_ML with its 5th and 95th percentile over resampled estimates, as a cell."""
        row = self.row(experiment)
        return f"{row['p_ml']:.1f} ({row['p_ml_low']:.1f} to {row['p_ml_high']:.1f})"


def with_unit(metres: float) -> str:
    """Return a length in metres, in kilometres from ten on."""
    return f"{length(metres)} m" if metres < 1e4 else f"{metres / 1e3:.0f} km"


def length(value: float) -> str:
    """Return a length [m] as a cell: metres, below a hundred to three digits."""
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def percent(value: float | None) -> str:
    """Return a percentage as a cell, NONE for None."""
    return NO_VALUE if value is None else f"{value:.1f}"


def rounded_cell(value: float, digits: int = 0) -> str:
    """Return a number with so many decimals, NO_VALUE where it is not finite."""
    return f"{value:.{digits}f}" if math.isfinite(value) else NO_VALUE


def extent_cell(extent: tuple[float, float] | None) -> str:
    """Return a range of percentages as a cell, NONE for None."""
    return NO_VALUE if extent is None else f"{extent[0]:.1f} to {extent[1]:.1f}"
