"""Beyond the paper: models against splits, other RSOs, RSOs left out, intervals, an error budget."""

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
    """The experiments of a study that asks whether its models generalise."""

    paper: Paper

    @property
    def study(self) -> Study:
        """The study that asks."""
        return self.paper.study

    @property
    def entry(self) -> Mapping[str, Any]:
        """What it asks of models and splits."""
        entry: Mapping[str, Any] = self.study.entry("beyond")
        return entry

    @cached_property
    def splits(self) -> dict[tuple[str, str, str], Experiment]:
        """The experiments by station set, learner and split."""
        return self._against_splits(self.entry["learners"], self.entry["splits"])

    def _against_splits(
        self, learners: list[str], splits: Mapping[str, tuple[str, str]]
    ) -> dict[tuple[str, str, str], Experiment]:
        return {
            (stations, learner, split): self.study.experiment(
                {}, stations=stations, learner=learner, train=train, test=test
            )
            for stations in self.entry["station_sets"]
            for learner in learners
            for split, (train, test) in splits.items()
        }

    @cached_property
    def transfers(self) -> dict[tuple[str, str, str], Experiment]:
        """The experiments of one model on other RSOs, by curve, learner and target."""
        entry = self.entry["transfers"]
        return {
            (name, learner, target): self._transfer(learner, target=target)
            for name, curve in self.paper.curves.items()
            for learner in entry["learners"]
            for target in curve.targets
        }

    @cached_property
    def left_out(self) -> dict[tuple[str, str, str], Experiment]:
        """The experiments on an RSO left out of its pool, by pool, learner and that RSO."""
        return {
            (pool, learner, rso): self._transfer(learner, rso=naming.leave_out(pool, rso), target=rso)
            for pool, rsos in self.study.entry("pools").items()
            for learner in self.entry["transfers"]["learners"]
            for rso in rsos
        }

    def _transfer(self, learner: str, **parts: str) -> Experiment:
        entry = self.entry["transfers"]
        return self.study.experiment({}, learner=learner, train=entry["train"], test=entry["test"], **parts)

    @cached_property
    def intervals(self) -> dict[tuple[str, str, str], Experiment]:
        """The experiments whose prediction intervals are made, by station set, learner and split."""
        entry = self.entry["intervals"]
        chosen = {split: self.entry["splits"][split] for split in entry["splits"]}
        return self._against_splits(entry["learners"], chosen)

    @cached_property
    def shown_intervals(self) -> dict[str, Experiment]:
        """Those that are drawn, by learner: all stations, the first split."""
        split = self.entry["intervals"]["splits"][0]
        stations = self.entry["station_sets"][-1]
        return {
            learner: self.intervals[stations, learner, split]
            for learner in self.entry["intervals"]["learners"]
        }

    @cached_property
    def budget(self) -> dict[tuple[str, str], Experiment]:
        """The experiments that take the error apart, by station set and learner. They need the truth."""
        entry = self.entry["budget"]
        found = self._against_splits(entry["learners"], {"budget": entry["split"]})
        return {(stations, learner): one for (stations, learner, _), one in found.items()}

    @cached_property
    def every(self) -> list[Experiment]:
        """Every experiment whose P_ML stands in the document, each once."""
        parts = (self.splits, self.transfers, self.left_out, self.budget)
        return list(dict.fromkeys(one for part in parts for one in part.values()))

    def published(self, found: Mapping[Any, Experiment]) -> dict[Any, float]:
        """The paper's P_ML [%] of experiments, where it gives one."""
        numbers = {key: self.paper.published(one) for key, one in found.items()}
        return {key: number for key, number in numbers.items() if number is not None}

    @cached_property
    def report(self) -> BeyondReport:
        """What the document of models against splits tells."""
        values = self.study.settings.values
        return BeyondReport(
            splits=self.splits,
            pairs={split: tuple(pair) for split, pair in self.entry["splits"].items()},
            transfers=self.transfers,
            left_out=self.left_out,
            budget=self.budget,
            budget_split=tuple(self.entry["budget"]["split"]),
            published=self.published(self.splits) | self.published(self.transfers),
            learners={name: naming.parse_learner(name, self.study.learners) for name in self._named},
            level=values["intervals"]["level"],
        )

    @property
    def _named(self) -> list[str]:
        return list(dict.fromkeys([*self.entry["learners"], *self.entry["budget"]["learners"]]))
