"""The plan of a run by its settings: studies, products, and the patterns of wildcards."""

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn

from opml import naming, tables
from opml.catalog import kinds
from opml.report.settings_tables import weather
from opml.study import truth_groups
from opml.study.experiments import Study
from opml.study.own_study import OwnStudy
from opml.study.paper import Paper
from opml.study.settings.merging import Settings
from opml.workflow.environment_files import EnvironmentFiles
from opml.workflow.product_paths import Product

_JOBS, _FEW = 4, 32  # jobs of a morning that are enough, and objects of one up to which there are fewer


def end_plan(error: object) -> NoReturn:
    """End the plan with one line, where Snakemake would put its own frame around the message."""
    sys.exit(f"opml: {error}")


@dataclass(frozen=True)
class Plan:
    """The settings of a run, and what follows from them for more than one rule."""

    settings: Settings

    @property
    def values(self) -> Mapping[str, Any]:
        """The settings as a mapping."""
        return self.settings.values

    @cached_property
    def study(self) -> Study:
        """The study of the run."""
        return Study(self.settings)

    @cached_property
    def paper(self) -> Paper:
        """The experiments of the paper."""
        return Paper(self.study)

    @cached_property
    def own_study(self) -> OwnStudy:
        """The experiments of a study of any RSO."""
        return OwnStudy(self.study)

    @cached_property
    def watched(self) -> dict[str, list[str]]:
        """The RSOs of every morning by the number of their job, in even shares; none without mornings.

        Jobs are few, as each reads all files, but enough for the cores of a machine.
        """
        if "day" not in self.values:
            return {}
        rsos = list(self.settings.measured)
        enough = min(_JOBS, math.ceil(len(rsos) / _FEW))
        jobs = max(enough, math.ceil(len(rsos) / self.settings.day.together))
        return {str(k): rsos[k * len(rsos) // jobs : (k + 1) * len(rsos) // jobs] for k in range(jobs)}

    @cached_property
    def environment(self) -> EnvironmentFiles:
        """The tables of the environment."""
        return EnvironmentFiles(self.settings.run)

    @cached_property
    def truth_groups(self) -> list[tuple[str, ...]]:
        """The RSOs of the studies, by the job that propagates their truths together."""
        return truth_groups.groups(self.study, self._rsos, results=Path(self.settings.run.results))

    @property
    def _rsos(self) -> list[str]:
        """The RSOs that the experiments of all studies train on and test, each once."""
        experiments = [
            *self.paper.reported,
            *(self.own_study.experiments.values() if self.own_study.is_asked else []),
        ]
        rsos = [rso for experiment in experiments for rso in (experiment.rso, experiment.target)]
        return list(dict.fromkeys(rsos))

    @cached_property
    def weather(self) -> str:
        """Knowledge that fits and predictions have of the space weather, as a line of a figure."""
        return weather(self.settings.run.environment).replace("`", "").rstrip(".")

    @property
    def window_hours(self) -> float:
        """Hours of tracks that an estimate is made of, where its name says no other."""
        return self.settings.run.estimation.window_hours

    def product(self, name: str) -> Product:
        """Return the paths of a product by its name below the results; wildcards in single braces."""
        return Product(self.settings.run.results, name)

    def window(self, hours: float) -> str:
        """Return the suffix of estimates over a window [h]."""
        return naming.window_suffix(hours, default=self.window_hours)

    @cached_property
    def constraints(self) -> dict[str, str]:
        """Regular expressions of the wildcards that rules share, by the wildcards' names."""
        rso = naming.rso_pattern(self.settings.rsos)
        noise = naming.seed_pattern(naming.NOISE, default=self.settings.run.seed.noise)
        split = naming.seed_pattern(naming.SPLIT, default=self.settings.run.seed.split)
        in_place = naming.alternatives(kinds.in_place_of_stations())
        return {
            "rso": rso,
            "target": rso,
            "stations": f"(?:{naming.stations_pattern(self.settings.stations)}{noise}|{in_place})",
            "window": naming.window_pattern(default=self.window_hours),
            "arc": naming.ARC_PATTERN,
            "memory": naming.MEMORY_PATTERN,
            "reading": f"(?:{naming.other_reading(self.study.cleaning.previous)})?",
            "label": f"(?:{self.label_pattern})?",
            "train": f"(?:{naming.TRAIN}){split}",
            "test": naming.TEST,
            "learner": naming.alternatives(self.settings.run.learners),
            "component": "|".join(tables.COMPONENTS),
            "evaluation": naming.alternatives(self.paper.evaluations),
            "ratio": r"[1-9]\d?",
            "date": naming.DATE,
            "grid": naming.alternatives(self.paper.grids),
            "curve": naming.alternatives(self.paper.curves),
        }

    @cached_property
    def label_pattern(self) -> str:
        """Regular expression of the suffix of labels from later estimates."""
        return naming.alternatives(filter(None, naming.LABELS.values()))
