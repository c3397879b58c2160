"""The paper's case as its settings give it, and where the comparison's files lie."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from opml.base.constants import DAY
from opml.base.yaml_files import read_yaml
from opml.catalog.fit.estimation_settings import Estimation
from opml.dynamics.settings import Integrator
from opml.learning.data.cleaning import Cleaning
from opml.orbits.sheets import Rso, Station, read_rsos, read_stations

ROOT = Path(__file__).parents[1]
REPORT = ROOT / "docs" / "tables" / "orekit.md"
TABLES = ROOT / "tests" / "reference"

PRECISE = "precise"
"""Name of the assumed model with tides and relativity."""

OURS_CONVERGED = Integrator(position_tolerance_m=1e-6, min_step_s=1e-4, max_step_s=10.0)
"""From steps of 20 s on, ours changes by rounding alone."""

OREKITS_CONVERGED = Integrator(position_tolerance_m=1e-6, min_step_s=1e-4, max_step_s=60.0)
"""Orekit's converged orbits end a step at each edge, so longer ones will do."""


@dataclass(frozen=True)
class Case:
    """The settings of config/config.yaml, its sheets, and the cleaning of the paper's study."""

    values: dict[str, Any]
    cleaning: Cleaning
    rsos: dict[str, Rso]
    stations: dict[str, Station]

    @classmethod
    def read(cls) -> "Case":
        """Return the paper's case. Raises InputError where a file is missing or malformed."""
        values = read_yaml(ROOT / "config" / "config.yaml")
        study = read_yaml(ROOT / "config" / "studies" / "paper.yaml")["study"]
        rsos, stations = (ROOT / values["sheets"][kind] for kind in ("rsos", "stations"))
        cleaning = Cleaning(**study["cleaning"])
        return cls(values, cleaning, read_rsos(rsos), read_stations(stations))

    @property
    def epoch(self) -> str:
        """UTC text."""
        return self.values["epoch"]

    @property
    def duration(self) -> float:
        """Length of a run [s]."""
        return DAY * self.values["duration_days"]

    @property
    def force_models(self) -> dict[str, dict[str, Any]]:
        """Degree, order and third bodies of the models 'truth' and 'assumed'."""
        return self.values["force_models"]

    @property
    def models(self) -> dict[str, dict[str, Any]]:
        """The settings' force models, and the assumed one with all that opml has: PRECISE."""
        more = {"forces": ["solid_tides", "relativity"]}
        return self.force_models | {PRECISE: self.force_models["assumed"] | more}

    @property
    def degree(self) -> int:
        """Highest degree of a force model."""
        return max(model["degree"] for model in self.force_models.values())

    @cached_property
    def integrator(self) -> Integrator:
        """The paper's integrator."""
        return Integrator(**self.values["integrator"])

    @cached_property
    def estimation(self) -> Estimation:
        """The paper's estimation."""
        return Estimation(**self.values["estimation"], cd_bounds=self.cleaning.cd_bounds)

    def random_times(self, count: int) -> np.ndarray:
        """Draw `count` times within the run [s], ascending."""
        seed = self.values["seed"]["split"]
        return np.sort(np.random.default_rng(seed).uniform(0.0, self.duration, count))
