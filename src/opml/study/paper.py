"""The experiments of the paper: of its figures and numbers, and of other readings of what it leaves open."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from opml import naming
from opml.naming import Experiment
from opml.orbits import sheets
from opml.report.paper_claims import Claim
from opml.report.reproduction import Headline, Reproduction
from opml.report.sections import section_of
from opml.study.experiments import Study, fence_of


@dataclass(frozen=True)
class Curve:
    """One model on RSOs that differ in one element: the inclination, or an offset of the semi-major axis."""

    targets: Mapping[str, float]  # the varied element [deg or km] by RSO
    experiments: Sequence[Experiment]
    first: Mapping[float, Experiment]  # of the first test, by the varied element
    published: Mapping[str, Mapping[str, float]]  # the paper's P_ML [%] by test and by the varied element


@dataclass(frozen=True)
class Paper:
    """The experiments of a study in the paper's form, part by part; a part that the study lacks has none."""

    study: Study

    @cached_property
    def evaluations(self) -> dict[str, Experiment]:
        """Experiments that have figures of their own, by the figures' name, in the paper's order."""
        entries = self.study.entry("evaluations")
        experiments = {name: self.study.experiment(entry) for name, entry in entries.items()}
        return dict(sorted(experiments.items(), key=lambda item: section_of(item[1])))

    def partition(self, ratio: int) -> Experiment:
        """Return the test on the rest after training on `ratio` % of the rows."""
        return self.study.experiment(self.study.entry("partition"), train=f"random-{ratio}", test="rest")

    @cached_property
    def partitions(self) -> list[Experiment]:
        """The partition curve's experiments."""
        return [self.partition(ratio) for ratio in self.study.entry("partition").get("ratios", [])]

    @cached_property
    def individual(self) -> Experiment:
        """The experiment whose errors are drawn prediction by prediction."""
        return self.evaluations[self.study.entry("individual")]

    @cached_property
    def grids(self) -> dict[str, dict[str, Experiment]]:
        """Each grid's experiments by RSO, each trained on itself."""
        return {
            name: {rso: self.study.experiment(entry, rso=rso) for rso in entry["rsos"]}
            for name, entry in self.study.entry("grids").items()
        }

    @cached_property
    def curves(self) -> dict[str, Curve]:
        """The curves over nearby RSOs."""
        return {name: self._curve(name, entry) for name, entry in self.study.entry("curves").items()}

    def _curve(self, name: str, entry: Mapping[str, Any]) -> Curve:
        targets = self._targets(name, entry)
        experiments = {
            (test, target): self.study.experiment(entry, test=test, target=target)
            for test in entry["tests"]
            for target in targets
        }
        return Curve(
            targets,
            list(experiments.values()),
            {value: experiments[entry["tests"][0], target] for target, value in targets.items()},
            entry.get("published", {}),
        )

    def _targets(self, name: str, entry: Mapping[str, Any]) -> dict[str, float]:
        """Return by a curve's RSOs the inclination [deg], or what is added to the semi-major axis [km]."""
        rso, sheet = entry.get("rso", self.study.defaults["rso"]), self.study.sheet
        named = sheets.name_at_inclination if name == "inclination" else sheets.name_at_offset
        return {named(rso, value, sheet): value for value in entry["values"]}

    @cached_property
    def datasets(self) -> list[tuple[str, str]]:
        """RSO and station set of every dataset that the evaluations and grids are made of, each once."""
        datasets = [(experiment.target, experiment.stations) for experiment in self.evaluations.values()]
        datasets += [
            (rso, experiment.stations) for grid in self.grids.values() for rso, experiment in grid.items()
        ]
        return list(dict.fromkeys(datasets))

    @cached_property
    def _numbers(self) -> list[tuple[str, Experiment, float]]:
        """Names, our experiments and P_ML [%] of the paper's numbers, in the order of its sections."""
        entries, partition = self.study.entry("evaluations"), self.study.entry("partition")
        numbers = [
            (name, experiment, entries[name]["published"])
            for name, experiment in self.evaluations.items()
            if "published" in entries[name]
        ]
        numbers += [
            (f"partition_{ratio}", self.partition(ratio), partition["published"][str(ratio)])
            for ratio in partition.get("shown", [])
            if str(ratio) in partition.get("published", {})
        ]
        return sorted(numbers, key=lambda number: section_of(number[1]))

    @cached_property
    def headlines(self) -> list[Headline]:
        """The paper's numbers with the experiments that ours are compared with."""
        return [
            Headline(
                name=name,
                experiment=experiment,
                published=published,
                over_splits=self.study.split_spread(experiment),
                over_noise=self.study.noise_spread(experiment),
                fixed=self._fix_scale(experiment),
                alternatives=self._alternatives(name, experiment),
            )
            for name, experiment, published in self._numbers
        ]

    def _fix_scale(self, experiment: Experiment) -> Experiment:
        return replace(experiment, learner=self.study.entry("reproduction")["fixed"])

    def _alternatives(self, name: str, experiment: Experiment) -> list[tuple[str, Experiment]]:
        """Return alternatives to a headline's experiment, each with the text of its change."""
        alternatives = [(text, read[name]) for text, read in self.readings.items() if name in read]
        text = f"the kernel scale is {self._fixed_scale:g}, not the default rule's"
        return [*alternatives, (text, self._fix_scale(experiment))]

    @property
    def _fixed_scale(self) -> float:
        """The kernel scale of the learner with a fixed one."""
        return float(self.study.learners[self.study.entry("reproduction")["fixed"]].get("kernel_scale"))

    @cached_property
    def readings(self) -> dict[str, dict[str, Experiment]]:
        """The experiments that show a reading's effect, by the reading's text and the headline.

        The partition is left out: its curve is the same experiment as the test with all stations.
        """
        entries = self.study.entry("reproduction").get("readings", {})
        shown = {name for name, _, _ in self._numbers}
        return {
            entry["text"]: {
                name: read
                for name, experiment in self.evaluations.items()
                if name in shown and (read := self._apply_reading(entry, experiment)) != experiment
            }
            for entry in entries.values()
        }

    def _apply_reading(self, entry: Mapping[str, Any], experiment: Experiment) -> Experiment:
        read, previous = experiment, self.study.cleaning.previous
        if "learner" in entry:
            read = replace(read, learner=entry["learner"])
        if entry.get("previous", previous) != previous:
            read = replace(read, reading=naming.READINGS[entry["previous"]])
        if "split" in entry:
            read = replace(read, train=re.sub("^(random|grouped)-", f"{entry['split']}-", read.train))
        if entry.get("windows") == "unseen":
            read = replace(read, test=naming.unseen_test(read.test))
        return replace(read, test=naming.with_fence(read.test, fence_of(entry.get("fence", "dataset"))))

    @cached_property
    def drawn_experiments(self) -> dict[str, Experiment]:
        """Every experiment whose number is drawn, by the figure and the point."""
        drawn = dict(self.evaluations)
        for ratio in self.study.entry("partition").get("ratios", []):
            drawn[f"partition_curve, {ratio} %"] = self.partition(ratio)
        for name, grid in self.grids.items():
            drawn |= {f"{name}_{rso}": experiment for rso, experiment in grid.items()}
        for name, curve in self.curves.items():
            drawn |= {f"{name}_curve, {point.target}, {point.test}": point for point in curve.experiments}
        return drawn

    @cached_property
    def reported(self) -> list[Experiment]:
        """Every experiment whose number stands in the reproduction, each once."""
        reported = [*self.evaluations.values(), *self.partitions, *self.drawn_experiments.values()]
        for headline in self.headlines:
            reported += [headline.experiment, headline.fixed, *headline.over_splits, *headline.over_noise]
        for experiments in self.readings.values():
            reported += experiments.values()
        return list(dict.fromkeys(reported))

    @cached_property
    def reproduction(self) -> Reproduction:
        """Contents of the report on the reproduction."""
        entry = self.study.entry("reproduction")
        learner = self.study.learners[self.study.defaults["learner"]]
        return Reproduction(
            headlines=self.headlines,
            readings=self.readings,
            evaluations=self.evaluations,
            claims=self.claims,
            drawn=self.drawn_experiments,
            rule=str(learner.get("kernel_scale")),
            fixed_scale=self._fixed_scale,
            calibrated=entry["calibrated"],
        )

    @cached_property
    def claims(self) -> list[Claim]:
        """The paper's claims in words, entry by entry, with the experiments that they are about."""
        limits = ("limit", "share", "start")
        return [
            Claim(
                claim["says"], claim["holds"], points, **{key: claim[key] for key in limits if key in claim}
            )
            for claim, points in self._claimed()
        ]

    def _claimed(self) -> Iterator[tuple[Mapping[str, Any], Mapping[str, Experiment]]]:
        """Yield what the paper says of each entry, and the experiments that it is about by their names."""
        for name, entry in self.study.entry("evaluations").items():
            for claim in entry.get("claims", []):
                yield claim, {point: self.evaluations[point] for point in [*claim.get("beside", []), name]}
        partition = self.study.entry("partition")
        for claim in partition.get("claims", []):
            yield claim, {f"{ratio} %": self.partition(ratio) for ratio in partition.get("ratios", [])}
        for name, entry in self.study.entry("grids").items():
            for claim in entry.get("claims", []):
                yield claim, self.grids[name]
        for name, entry in self.study.entry("curves").items():
            unit, first = {"inclination": "deg", "semi_major_axis": "km"}[name], self.curves[name].first
            for claim in entry.get("claims", []):
                values = (value for value in sorted(first) if value > claim.get("beyond", -1e9))
                yield claim, {f"{value:g} {unit}": first[value] for value in values}
