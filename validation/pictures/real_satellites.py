"""Draw the pictures of real satellites: README's, the overview, and whether the ellipsoids are true.

    python -m validation.pictures.real_satellites results

Reads the finished studies of config/studies that NAMES lists, each from its folder in `results`, and of the
first one the replay of `svr`, which no study makes by itself.
"""

import argparse
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from opml.base.constants import WGS84_A
from opml.base.errors import InputError
from opml.figures.display_names import display_rso
from opml.figures.reliability import coverage_curves
from opml.figures.style import save
from opml.learning.judge import calibration
from opml.learning.judge.model_choice import Mornings
from opml.study.experiments import Study
from opml.study.own_study import OwnStudy
from opml.study.settings.merging import merged, with_sheets
from opml.tables import ELLIPSOID, read_table
from validation.case import ROOT
from validation.pictures import satellite_figures as figures
from validation.pictures.shrunk import IMAGES, shrink

NAMES = ("swarm", "larets", "sentinel3a", "lageos2")
NOTE = (
    "tracks of three radars, simulated on a precise orbit; predictions fly under the space weather that was "
    "forecast that day"
)


@dataclass(frozen=True)
class Satellite:
    """A finished study of one real satellite.

    study: its experiments
    results: its folder
    """

    study: OwnStudy
    results: Path

    @classmethod
    def read(cls, name: str, results: Path) -> "Satellite":
        """Return a study of config/studies by its name; results: the folder with the folders of all."""
        files = [ROOT / "config" / "config.yaml", ROOT / "config" / "studies" / f"{name}.yaml"]
        return cls(OwnStudy(Study(with_sheets(merged(files).values))), results / name)

    @property
    def name(self) -> str:
        """As a figure writes it."""
        return display_rso(self.study.study.rsos[0])

    @property
    def title(self) -> str:
        """Its name, and how many predictions there are."""
        return f"{self.name}, {len(self.mornings.flown)} predictions"

    @property
    def altitude(self) -> float:
        """Median height above the equator's radius [m]."""
        truth = read_table(self.results / "truth" / f"{self.study.study.rsos[0]}.parquet", "truth")
        return float(np.median(np.linalg.norm(truth[["x", "y", "z"]], axis=1))) - WGS84_A

    def replay(self, learner: str) -> pd.DataFrame:
        """Return the `replay` table of a learner."""
        ((rso, stations),) = self.study.datasets
        days = self.study.splits[self.study.shown_split][0]
        return read_table(self.results / "replays" / rso / stations / days / f"{learner}.parquet", "replay")

    @property
    def fit(self) -> pd.DataFrame:
        """The `calibration` table of the fits' own covariances."""
        (path,) = (self.results / "fit_calibration").rglob("*.parquet")
        return read_table(path, "calibration")

    @cached_property
    def mornings(self) -> Mornings:
        """The mornings of all models that the study replays."""
        replays = {name: self.replay(name) for name in self.study.replayed_models}
        return Mornings.from_replays(replays, self.study.laws, seed=self.study.study.settings.run.seed.split)

    @property
    def tables(self) -> dict[str, pd.DataFrame]:
        """What figures compare: rows of `replay` tables of the same predictions."""
        mornings, laws = self.mornings, self.study.laws
        plain = mornings.best([name for name in mornings.tables if name not in laws])
        before = mornings.flown.assign(e_y=mornings.flown["before"])
        return {
            figures.BEFORE: before,
            figures.PLAIN: mornings.tables[plain],
            figures.CHOSEN: mornings.flown,
        }

    def beside(self, replay: pd.DataFrame) -> pd.DataFrame:
        """Return the rows of a `replay` table that are of the predictions of the mornings."""
        pairs = self.mornings.flown[["i", "j"]]
        return replay.merge(pairs, on=["i", "j"])


def pictures(results: Path) -> dict[str, Figure]:
    """Return the figures by the picture's name; results: the folder with a folder for each study."""
    satellites = [Satellite.read(name, results) for name in NAMES]
    first, days = satellites[0], satellites[0].study.report.durations
    replayed = {one.title: one.mornings.flown for one in satellites}
    fits = {f"{one.name}, the fit's own": one.fit for one in satellites[:2]}
    return {
        "swarm": figures.headline(
            f"{first.name}, September 2019",
            first.tables | {figures.PAPER: first.beside(first.replay("svr"))},
            note=NOTE,
        ),
        "satellites": figures.overview(
            {one.name: one.tables for one in satellites},
            {one.name: one.altitude for one in satellites},
            note=NOTE,
        ),
        "ellipsoids": coverage_curves(
            calibration.of_replays(replayed, days=days) | fits,
            quantity=ELLIPSOID,
            note="chosen by the past each morning, and before correction with the fit's own covariance",
        ),
    }


def main() -> None:
    """Draw the three pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path, help="folder with a folder of results for each study")
    try:
        drawn = pictures(parser.parse_args().results)
    except InputError as error:
        sys.exit(f"opml: {error}")
    with TemporaryDirectory() as folder:
        for name, figure in drawn.items():
            whole = Path(folder) / f"{name}.png"
            save(figure, whole.with_suffix(".pdf"), whole)
            shrink(whole, IMAGES / f"{name}.png")


if __name__ == "__main__":
    main()
