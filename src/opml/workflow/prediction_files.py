"""Files that `opml predict` writes, by their suffixes."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath, replacing, suffix_of
from opml.element_sets import station_passes
from opml.element_sets.inside.orbit_prediction import OrbitInside
from opml.element_sets.prediction import Prediction
from opml.element_sets.station_passes import Place
from opml.interop import czml
from opml.interop.element_sets import omm, rewriting, tle
from opml.interop.predicted_orbit import PredictedOrbit
from opml.tables import write_as

Passes = Mapping[Place, pd.DataFrame]  # tables `passes` by station
Writer = Callable[[FilePath, Any, Passes], None]


def check(paths: Sequence[FilePath]) -> None:
    """Raise InputError for a path whose suffix has no format, and for a page without what draws it."""
    for path in paths:
        if suffix_of(path, WRITERS) == ".html" and find_spec("matplotlib") is None:
            raise InputError(f"{path}: expected matplotlib, got none: pip install 'opml-orbits[workflow]'")


def write_passes(path: FilePath, passes: Passes) -> None:
    """Write passes over all stations as CSV, JSON or Parquet, by the suffix; raise InputError without one."""
    if not passes:
        raise InputError("--passes: expected a --station, got none")
    write_as(path, station_passes.joined(passes), "passes", metadata={})


def check_fitted(paths: Sequence[FilePath]) -> None:
    """Raise InputError for a path whose suffix is of no set that is fitted to an ephemeris."""
    for path in paths:
        if Path(path).suffix.lower() == ".xml":
            raise InputError(f"{path}: expected .tle or .kvn for a set that is fitted to points or tracks")


def write(path: FilePath, prediction: PredictedOrbit, passes: Passes) -> None:
    """Write a prediction in the format of the suffix, whole or not at all; passes: by station."""
    WRITERS[Path(path).suffix.lower()](path, prediction, passes)


def _set(path: FilePath, prediction: PredictedOrbit, _: Passes) -> None:
    if not isinstance(prediction, Prediction) or isinstance(prediction.inside, OrbitInside):
        _fitted_set(path, prediction)
    elif rewriting.write(path, [prediction.better]):
        raise InputError(f"{path}: expected an object whose number a TLE has, got {prediction.identity}")


def _fitted_set(path: FilePath, prediction: PredictedOrbit) -> None:
    """Write the set by which SGP4 comes nearest to a prediction."""
    from opml.interop.element_sets import element_fits  # SciPy's optimizers: a quarter of a second

    ephemeris, epoch, identity = prediction.ephemeris, prediction.date, prediction.identity
    satellite = element_fits.fit_ephemeris(ephemeris, epoch=epoch)
    if Path(path).suffix.lower() == ".tle":
        tle.write(path, satellite, identity)
        return
    residual = element_fits.residual(satellite, ephemeris, epoch=epoch)
    omm.write(path, satellite, identity=identity, epoch=epoch, comment=residual)


def _table(path: FilePath, prediction: PredictedOrbit, _: Passes) -> None:
    metadata = {"object": str(prediction.identity), "used": prediction.way, "why": prediction.reason}
    write_as(path, prediction.expected(), "expected_errors", metadata=metadata)


def _czml(path: FilePath, prediction: PredictedOrbit, _: Passes) -> None:
    positions = prediction.ephemeris.states[:, :3]
    czml.write(path, prediction.identity.name, prediction.t, positions, epoch=prediction.date)


def _page(path: FilePath, prediction: PredictedOrbit, passes: Passes) -> None:
    from opml.figures import prediction_figures as figures
    from opml.figures.style import save_png
    from opml.report import prediction_page as report
    from opml.report.document import Picture, html_page

    drawn = {"track.png": (figures.ground_track(prediction, [*passes]), "Ground track of the first day")}
    if np.isfinite(prediction.sigmas(prediction.t[:1])).all():
        shows = "Expected errors along the track by days ahead"
        drawn = {"errors.png": (figures.expected_errors(prediction), shows), **drawn}
    with tempfile.TemporaryDirectory() as folder, replacing(path) as temporary:
        pictures = []
        for name, (figure, shows) in drawn.items():
            save_png(figure, Path(folder, name))
            pictures.append(Picture(Path(folder, name), name, shows))
        blocks = report.document(prediction, passes, pictures)
        temporary.write_text(html_page(blocks, title=str(prediction.identity)), encoding="utf-8")


WRITERS: dict[str, Writer] = {
    ".oem": lambda path, prediction, _: prediction.to_oem(path),
    ".tle": _set,
    ".kvn": _set,
    ".xml": _set,
    ".csv": _table,
    ".json": _table,
    ".czml": _czml,
    ".html": _page,
}
"""By suffix; sets in JSON and CSV are written by `opml improve`."""
