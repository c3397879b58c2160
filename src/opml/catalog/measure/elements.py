"""Histories of mean elements, whose theory gives the points of a table `fixes`."""

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.catalog.kinds import MeasurementRequest
from opml.interop.element_sets import histories

FEWEST_SETS = 3  # sets of mean elements that a window of fits holds at least: Cd goes wild in fits to fewer


def check(asked: MeasurementRequest) -> None:
    """Look at histories: their object, and whether the run and windows of fits hold enough sets."""
    history = histories.read(asked.paths, epoch=asked.epoch, leave_out_damaged=asked.taking.leave_out_damaged)
    sets = histories.of_object(history.sets, asked.taking.number)
    within = sets["t"][sets["t"].between(0.0, asked.duration)]
    if len(within) < FEWEST_SETS:
        raise InputError(
            f"element sets: expected {FEWEST_SETS} sets or more within the run, got {len(within)}"
        )
    hours, window = float(within.diff().median()) / HOUR, asked.window_hours
    if window < FEWEST_SETS * hours:
        expected = f"{FEWEST_SETS} sets or more in a window of fits, estimation.window_hours"
        raise InputError(f"element sets: expected {expected}, got sets {hours:.1f} h apart and {window:g}")
