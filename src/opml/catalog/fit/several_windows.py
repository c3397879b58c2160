"""Fits of one track over windows of several lengths: their arcs fly side by side, as fast as the longest."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest

import numpy as np
import pandas as pd

from opml.catalog.fit.estimation import Run
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.measurements import Measurements
from opml.catalog.fit.solutions import solutions
from opml.catalog.flight import Flight


def estimate(
    flight: Flight,
    starts: pd.DataFrame,
    measured: Measurements,
    *,
    settings: Estimation,
    track: int,
    earlier: Mapping[float, pd.DataFrame],
) -> pd.DataFrame:
    """Return the rows of `estimates` of a track over windows, each as `estimate_further` has it.

    flight: under the assumed model
    starts: the table
    settings: of all windows but their length
    earlier: by the length of each window [h], rows of tracks before that fits over it may start from

    Besides, the window of each row, `window_hours`.
    """
    runs = [Run.of_starts(flight, starts, measured, settings.evolve(window_hours=hours)) for hours in earlier]
    windows = [run.window(track) for run in runs]
    candidates = [
        run.starts_in_turn([window], *run.newest(solutions(rows, measured.at), None, None))
        for run, window, rows in zip(runs, windows, earlier.values(), strict=True)
    ]
    methods = [run.method(run.free_parameters()) for run in runs]
    estimates = runs[0].fit_windows(windows, _side_by_side(candidates), methods)
    rows = [run.row(estimate) for run, estimate in zip(runs, estimates, strict=True)]
    return pd.DataFrame(rows).assign(window_hours=list(earlier))


def _side_by_side(candidates: Sequence[Iterator[np.ndarray]]) -> Iterator[np.ndarray]:
    """Yield the starts (windows, 7) of all windows, not finite where one has no more."""
    return map(np.concatenate, zip_longest(*candidates, fillvalue=np.full((1, 7), np.nan)))
