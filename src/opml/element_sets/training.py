"""Training of a model on the element sets of populations of objects, such as payloads and fragments."""

import hashlib
import logging
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.progress import Progress, with_time_left
from opml.base.provenance import code_digest, commit
from opml.element_sets import catalogue as catalogues, corrector, density, features, set_errors
from opml.element_sets.density import Air
from opml.element_sets.trained_model import CatalogueModel
from opml.environment import known_weather, solar_activity
from opml.interop.element_sets.known_sets import find_files

HOUR_OF_MORNING = 0.25  # time of day [d] of the mornings that are learned from, 06 UTC
FIRST_DAY = 52275  # modified Julian day from which the forecast of the density learns, 2002-01-01
SEED = 42  # seed of the draws of a training
LIBRARIES = ("numba", "numpy", "pandas", "scikit-learn", "scipy", "sgp4")  # whose versions a card has

_log = logging.getLogger(__name__)


def train(
    populations: Mapping[str, Iterable[FilePath]],
    *,
    weather: str | Path,
    date: str | None = None,
    seed: int = SEED,
    progress: Progress = _log.info,
) -> CatalogueModel:
    """Return a model of the sets in files and folders, by the name of the population.

    weather: OBSERVED or a CSSI file; what comes after its measurements is not learned from
    date: UTC text; sets and weather that were not known then are not learned from

    Raises InputError for unreadable files, and where there is too little to learn from.
    """
    found_files = {name: find_files(paths) for name, paths in populations.items()}
    end = np.inf if date is None else epochs.mjd(date)
    sets = {name: catalogues.read(files).until(end).daily() for name, files in found_files.items()}
    for name, known_sets in sets.items():
        if known_sets.table.empty:
            raise InputError(f"{name}: expected sets that were public on {date}, got none")
    measured = known_weather.read(weather)
    known = density.clean(measured if date is None else measured.keep_known(end))
    progress("densities of the thermosphere since 2002")
    correctors, cards = {}, {}
    with threadpool_limits(limits=1, user_api="blas"):  # sums in one order, whatever the machine
        air, outlook = density.learned_air(known, first=FIRST_DAY, end=known.end)
        for name, files in with_time_left(list(found_files.items()), "population", progress):
            progress(f"{name}: predictions")
            rows = mornings_of(sets[name], air)
            progress(f"{name}: {len(rows)} predictions to learn from")
            correctors[name] = corrector.fit(rows, seed=seed)
            cards[name] = card(rows, files)
    model_card = {
        "populations": cards,
        "seed": seed,
        "weather": _digests([solar_activity.resolve(weather)]),
        "weather_to": epochs.calendar(np.ceil(known.end) - 1.0),
        "software": _software(),
    }
    return CatalogueModel(outlook, correctors, model_card | ({"date": date} if date else {}))


def mornings_of(sets: catalogues.ElementCatalogue, air: Air) -> pd.DataFrame:
    """Return the rows of `features.build` for each morning between the first and the last set."""
    t = sets.table["t"]
    mornings = np.arange(np.ceil(t.min()), np.ceil(t.max()) + 1.0) + HOUR_OF_MORNING
    return features.build(sets, set_errors.build(sets, mornings), air)


def card(rows: pd.DataFrame, files: Iterable[Path]) -> dict[str, Any]:
    """Return the data of a population for a model card: files with digests, span, objects, rows."""
    known = rows[rows["is_fit"] & np.isfinite(rows["target"])]
    if known.empty:
        raise InputError("element sets: expected objects with later sets to learn from, got none")
    return {
        "files": _digests(files),
        "from": epochs.calendar(known["morning"].min()),
        "to": epochs.calendar(known["morning"].max()),
        "objects": int(known["number"].nunique()),
        "rows": len(known),
    }


def _software() -> dict[str, str]:
    """Return what made a model: digest of the modules that count, without its own file, commit, versions."""
    modules = (catalogues, corrector, density, features, set_errors)
    code = code_digest(*(module.__name__ for module in modules))
    return {"code": code, "commit": commit(), **{name: version(name) for name in LIBRARIES}}


def _digests(files: Iterable[Path]) -> dict[str, str]:
    """Return the SHA-256 of files by their name."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
