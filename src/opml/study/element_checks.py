"""Learners that suit a study: of public mean elements, and of fits that filters know nothing of."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from opml import naming
from opml.environment import nrlmsis
from opml.study.experiments import FILTERS, Study
from opml.study.settings.overlay import Key, Source
from opml.tables import IMPROVED_MODELS


def check_learners(source: Source, study: Study) -> None:
    """Raise InputError where a study asks for SGP4 without mean elements, or for a filter that cannot be.

    So it does for improved sets without the model of the density.

    A filter goes forwards, and takes all measurements as they are. RSOs all have mean elements, or none has.
    """
    has_elements = study.has_elements(study.rsos[0])
    for rso in study.rsos:
        if study.has_elements(rso) != has_elements:
            raise source.wrong(("study", "rsos"), f"expected RSOs that all have elements, or none, got {rso}")
    for key, names in _learners_named(study.settings.asked):
        for name in names:
            kind = naming.parse_learner(name, study.learners).kind
            if kind in ("sgp4", *IMPROVED_MODELS) and not has_elements:
                raise source.wrong(key, f"expected RSOs that have elements for {name}, got others")
            if kind in IMPROVED_MODELS:
                with source.naming(key):
                    nrlmsis.check_installed()
            if kind in FILTERS and study.not_filtered:
                expected = f"expected fits over windows, as filters know no estimation.{study.not_filtered}"
                raise source.wrong(key, f"{expected}, got {name}")
            if kind in FILTERS and has_elements:
                expected = "expected fits over windows, as points of mean elements overlap in time"
                raise source.wrong(key, f"{expected}, got {name}")


def _learners_named(asked: Mapping[str, Any]) -> Iterator[tuple[Key, Sequence[str]]]:
    yield ("study", "learners"), asked.get("learners", [])
    yield ("study", "replayed"), asked.get("replayed", [])
