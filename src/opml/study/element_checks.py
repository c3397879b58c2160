"""Checks of a study of public mean elements: their files, their windows, and the learners that suit them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from opml import naming
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.interop.element_sets import histories
from opml.orbits import sheets
from opml.study.experiments import FILTERS, Study
from opml.study.settings.merging import Settings
from opml.study.settings.overlay import Key, Source

FEWEST_SETS = 3
"""Sets of mean elements that a window of fits holds at least: Cd goes wild in fits to fewer."""


def check(source: Source, settings: Settings) -> None:
    """Look at histories of mean elements: their RSO, their object, and whether windows hold enough sets."""
    for name in settings.values.get("histories", {}):
        if name not in settings.elements:
            raise source.wrong(("histories", name), "expected an RSO that has elements")
    values = source.values
    for name, paths in settings.elements.items():
        history = settings.history(name)
        with source.naming(("elements", name)):
            sheets.parse_rso(name, settings.rsos)
            if name in settings.tracks | settings.fixes:
                raise InputError("expected elements, tracks or fixes, got more than one of them")
            found = histories.read(paths, epoch=values["epoch"], leave_out_damaged=history.leave_out_damaged)
            sets = histories.of_object(found.sets, history.number)
            epochs_within = sets["t"][sets["t"].between(0.0, DAY * values["duration_days"])]
            if len(epochs_within) < FEWEST_SETS:
                expected = f"{FEWEST_SETS} sets or more within the run"
                raise InputError(f"element sets: expected {expected}, got {len(epochs_within)}")
        window, hours = values["estimation"]["window_hours"], float(epochs_within.diff().median()) / HOUR
        if window < FEWEST_SETS * hours:
            expected = f"a window that holds {FEWEST_SETS} sets of {name} or more, {hours:.1f} h apart"
            raise source.wrong(("estimation", "window_hours"), f"expected {expected}, got {window:g}")


def check_learners(source: Source, study: Study) -> None:
    """Raise InputError where a study asks for SGP4 without mean elements, or for a filter that cannot be.

    A filter goes forwards, and takes all measurements as they are. RSOs all have mean elements, or none has.
    """
    has_elements = study.has_elements(study.rsos[0])
    for rso in study.rsos:
        if study.has_elements(rso) != has_elements:
            raise source.wrong(("study", "rsos"), f"expected RSOs that all have elements, or none, got {rso}")
    for key, names in _learners_named(study.settings.asked):
        for name in names:
            kind = naming.parse_learner(name, study.learners)["kind"]
            if kind == "sgp4" and not has_elements:
                raise source.wrong(key, f"expected RSOs that have elements for {name}, got others")
            if kind in FILTERS and study.not_filtered:
                expected = f"expected fits over windows, as filters know no estimation.{study.not_filtered}"
                raise source.wrong(key, f"{expected}, got {name}")
            if kind in FILTERS and has_elements:
                expected = "expected fits over windows, as points of mean elements overlap in time"
                raise source.wrong(key, f"{expected}, got {name}")


def _learners_named(asked: Mapping[str, Any]) -> Iterator[tuple[Key, Sequence[str]]]:
    """Yield key and names of the learners of a study of one's own."""
    yield ("study", "learners"), asked.get("learners", [])
    yield ("study", "replayed"), asked.get("replayed", [])
    yield ("study", "rolling", "learners"), asked.get("rolling", {}).get("learners", [])
