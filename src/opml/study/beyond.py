"""The experiments beyond the paper: models against splits, and on other RSOs."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from opml import naming
from opml.naming import Experiment
from opml.report.beyond import BeyondReport
from opml.study.experiments import Study
from opml.study.paper import Paper


@dataclass(frozen=True)
class Beyond:
    """The experiments that show whether a study's models generalise."""

    paper: Paper

    @property
    def study(self) -> Study:
        """The study whose models these are."""
        return self.paper.study

    @property
    def entry(self) -> Mapping[str, Any]:
        """The study's settings of these experiments."""
        return self.study.entry("beyond")

    @cached_property
    def splits(self) -> dict[tuple[str, str, str], Experiment]:
        """Every learner against every split, by station set, learner and split."""
        return {
            (stations, learner, split): self.study.experiment(
                {}, stations=stations, learner=learner, train=train, test=test
            )
            for stations in self.entry["station_sets"]
            for learner in self.entry["learners"]
            for split, (train, test) in self.entry["splits"].items()
        }

    @cached_property
    def transfers(self) -> dict[tuple[str, str, str], Experiment]:
        """One model on other RSOs, by curve, learner and target."""
        train, test = self.entry["transfer_split"]
        split = {"train": train, "test": test}
        return {
            (name, learner, target): self.study.experiment({}, learner=learner, target=target, **split)
            for name, curve in self.paper.curves.items()
            for learner in self.entry["transfers"]
            for target in curve.targets
        }

    @cached_property
    def every(self) -> list[Experiment]:
        """Every experiment whose P_ML stands in the document, each once."""
        parts = (self.splits, self.transfers)
        return list(dict.fromkeys(experiment for part in parts for experiment in part.values()))

    def published_p_ml(self, experiments: Mapping[Any, Experiment]) -> dict[Any, float]:
        """Return the paper's P_ML [%] of experiments by their keys, where it gives a number."""
        numbers = {key: self.paper.published_p_ml(experiment) for key, experiment in experiments.items()}
        return {key: number for key, number in numbers.items() if number is not None}

    @cached_property
    def report(self) -> BeyondReport:
        """Contents of the report on models against splits."""
        return BeyondReport(
            splits=self.splits,
            pairs={split: tuple(pair) for split, pair in self.entry["splits"].items()},
            transfers=self.transfers,
            published=self.published_p_ml(self.splits) | self.published_p_ml(self.transfers),
            learners={
                name: naming.parse_learner(name, self.study.learners) for name in self.entry["learners"]
            },
        )
