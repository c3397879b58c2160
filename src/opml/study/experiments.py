"""A study: its defaults and seeds, and the experiments that its entries become."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from opml import naming
from opml.catalog.kinds import Kind
from opml.learning.data.cleaning import Cleaning
from opml.learning.models.contract import LearnerSettings
from opml.naming import Experiment
from opml.orbits.sheets import Rso
from opml.study.settings.merging import Settings

SIMULATED, FILES, MEASURED = "simulated", "files", "measured"  # where an RSO's orbit comes from


def fence_of(word: str | float) -> float | None:
    """Return the fence of tested rows [IQR] of a setting: None for the dataset's, infinity for no fence."""
    match word:
        case "dataset":
            return None
        case "none":
            return math.inf
    return float(word)


@dataclass(frozen=True)
class Study:
    """The study of a run, part by part; what an entry leaves out is taken from the defaults."""

    settings: Settings

    def __contains__(self, part: str) -> bool:
        return part in self.settings.study

    def entry(self, part: str) -> Any:
        """Return a part of the study's settings, empty where the study has none."""
        return self.settings.study.get(part, {})

    @property
    def sheet(self) -> Mapping[str, Rso]:
        """The RSOs that names may start from."""
        return self.settings.rsos

    @property
    def learners(self) -> Mapping[str, LearnerSettings]:
        """The learners' settings, by name."""
        return self.settings.run.learners

    @cached_property
    def rsos(self) -> list[str]:
        """The RSOs that the study is about."""
        return list(
            self.settings.study.get("rsos") or [self.entry("defaults").get("rso") or next(iter(self.sheet))]
        )

    @cached_property
    def station_sets(self) -> list[str]:
        """The station sets that the study is about."""
        named = self.settings.study.get("station_sets") or [self.entry("defaults").get("stations")]
        # All stations together, or the name in their place where none of the sheet measured the RSOs.
        in_place = filter(None, map(self.in_place_of_stations, self.rsos))
        usual = next(in_place, "-".join(self.settings.stations))
        return [stations or usual for stations in named]

    def in_place_of_stations(self, rso: str) -> str:
        """Return the name in the place of stations, '' where those of the sheet measure an RSO."""
        kind = self.kind_of(rso)
        return kind.stations if kind else ""

    def kind_of(self, rso: str) -> Kind | None:
        """Return how an RSO was measured; None where its measurements are simulated."""
        return self.settings.kind_of(self._row(rso))

    def _row(self, rso: str) -> str:
        return naming.rso_parts(rso, self.sheet)[0]

    @cached_property
    def defaults(self) -> dict[str, str]:
        """RSO, station set, learner and component of every entry that names none."""
        first = {"rso": self.rsos[0], "stations": self.station_sets[-1]}
        return first | {"learner": "svr", "component": "e_y"} | dict(self.entry("defaults"))

    @cached_property
    def cleaning(self) -> Cleaning:
        """Rows that the study drops; by default only those that no model can correct."""
        return Cleaning(**self.entry("cleaning"))

    @cached_property
    def label(self) -> str:
        """Reference of predictions where an entry names none: truth or later.

        By default the truth, or later estimates where an RSO of the study was measured: its truth, if it has
        one, only judges.
        """
        default = "later" if any(self.is_measured(rso) for rso in self.rsos) else "truth"
        return str(self.settings.study.get("label", default))

    def is_measured(self, rso: str) -> bool:
        """Return whether measurements of an RSO are real, so that none are simulated."""
        return self.kind_of(rso) is not None

    def has_truth(self, rso: str) -> bool:
        """Return whether the true orbit of an RSO is known: simulated, or from files."""
        return self.truth_of(rso) != MEASURED

    def truth_of(self, rso: str) -> str:
        """Return where an RSO's true orbit comes from: SIMULATED, FILES, or MEASURED if unknown."""
        if self._row(rso) in self.settings.orbits:
            return FILES
        return MEASURED if self.is_measured(rso) else SIMULATED

    @property
    def span_days(self) -> Sequence[float]:
        """Window of t_j that random splits draw from [days]: by default the training days, else the run."""
        days = self.entry("days").get("train") or [0, self.settings.run.duration_days]
        return self.settings.study.get("span_days") or days

    def experiment(self, entry: Mapping[str, Any], **parts: str) -> Experiment:
        """Return the experiment of an entry with `parts` over it; the target is its RSO by default."""
        settings = {**entry, **parts}
        fields = {key: settings[key] for key in settings if key in Experiment.__dataclass_fields__}
        names = self.defaults | fields
        label = naming.LABELS[settings.get("label", self.label)]
        return Experiment(**({"target": names["rso"]} | names | {"label": label}))

    def with_seeds(
        self, experiment: Experiment, *, noise: int | None = None, split: int | None = None
    ) -> Experiment:
        """Return an experiment under other seeds; None stands for the run's own."""
        default = self.settings.run.seed
        noise = default.noise if noise is None else noise
        split = default.split if split is None else split
        return replace(
            experiment,
            stations=naming.add_seed(experiment.stations, naming.NOISE, noise, default=default.noise),
            train=naming.add_seed(experiment.train, naming.SPLIT, split, default=default.split),
        )

    def split_spread(self, experiment: Experiment) -> list[Experiment]:
        """Return an experiment under the split seeds that its spread is stated over."""
        return [self.with_seeds(experiment, split=seed) for seed in self._seeds("split")]

    def noise_spread(self, experiment: Experiment) -> list[Experiment]:
        """Return an experiment under the noise seeds that its spread is stated over.

        Empty for a transfer to another RSO: it would need that RSO measured anew under each seed.
        """
        if experiment.target != experiment.rso:
            return []
        return [self.with_seeds(experiment, noise=seed) for seed in self._seeds("noise")]

    def _seeds(self, kind: str) -> Sequence[int]:
        return self.entry("seeds").get(kind) or [getattr(self.settings.run.seed, kind)]
