"""The paper's experiments as its study asks for them: figures, numbers, readings of what it leaves open."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from opml import naming
from opml.naming import Experiment
from opml.orbits import sheets
from opml.report.claims import Claim
from opml.report.reproduction import Headline, Reproduction
from opml.report.sections import section_of
from opml.study.experiments import Study, fence_of
from opml.tables import COMPONENTS


@dataclass(frozen=True)
class Curve:
    """One model on RSOs that differ in one element: what is varied by target, and the experiments."""

    targets: Mapping[str, float]
    experiments: Sequence[Experiment]
    first: Mapping[float, Experiment]  # of the first test, by what is varied
    published: Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class Paper:
    """The experiments of a study in the paper's form; a part that is not asked for has none."""

    study: Study

    @cached_property
    def evaluations(self) -> dict[str, Experiment]:
        """Experiments that have figures of their own, by the figures' name, in the paper's order."""
        entries = self.study.entry("evaluations")
        found = {name: self.study.experiment(entry) for name, entry in entries.items()}
        return dict(sorted(found.items(), key=lambda item: section_of(item[1])))

    def partition(self, ratio: int) -> Experiment:
        """The test on the rest after training on `ratio` % of the rows."""
        return self.study.experiment(self.study.entry("partition"), train=f"random-{ratio}", test="rest")

    @cached_property
    def partitions(self) -> list[Experiment]:
        """The partition curve's experiments, of all seeds that are drawn."""
        ratios = self.study.entry("partition").get("ratios", [])
        return [one for ratio in ratios for one in self.study.drawn_seeds(self.partition(ratio))]

    @cached_property
    def individual(self) -> Experiment:
        """The experiment that is drawn point by point."""
        return self.evaluations[self.study.entry("individual")["evaluation"]]

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
        one = {
            (test, target): self.study.experiment(entry, test=test, target=target)
            for test in entry["tests"]
            for target in targets
        }
        return Curve(
            targets,
            [seeded for experiment in one.values() for seeded in self.study.drawn_seeds(experiment)],
            {value: one[entry["tests"][0], target] for target, value in targets.items()},
            entry.get("published", {}),
        )

    def _targets(self, name: str, entry: Mapping[str, Any]) -> dict[str, float]:
        """A curve's RSOs and what is varied: the inclination [deg] or what is added to the axis [km]."""
        rso, sheet = entry.get("rso", self.study.defaults["rso"]), self.study.sheet
        if name == "inclination":
            return {sheets.name_at_inclination(rso, value, sheet): value for value in entry["inclinations"]}
        return {sheets.name_at_offset(rso, value, sheet): value for value in entry["offsets"]}

    @cached_property
    def kernel_scales(self) -> list[Experiment]:
        """Experiments with one fixed kernel scale each: every scale, split and station set."""
        entry = self.study.entry("kernel_scale")
        learner = entry.get("learner", self.study.defaults["learner"])
        return [
            self._kernel_scale(stations, split, naming.scale_kernel(learner, scale))
            for stations in entry.get("station_sets", [])
            for split in entry["splits"]
            for scale in entry["scales"]
        ]

    @cached_property
    def kernel_rules(self) -> list[Experiment]:
        """Experiments whose models tell the scales of the rules: the first split, each station set."""
        entry = self.study.entry("kernel_scale")
        return [
            self._kernel_scale(stations, entry["splits"][0], learner)
            for stations in entry.get("station_sets", [])
            for learner in entry["rules"]
        ]

    def _kernel_scale(self, stations: str, split: Sequence[str], learner: str) -> Experiment:
        entry = self.study.entry("kernel_scale")
        return self.study.experiment(entry, stations=stations, learner=learner, train=split[0], test=split[1])

    @cached_property
    def components(self) -> dict[str, list[Experiment]]:
        """Experiments of the table of components, by evaluation."""
        return {
            name: [replace(self.evaluations[name], component=component) for component in COMPONENTS]
            for name in self.study.entry("components")
        }

    def published(self, experiment: Experiment) -> float | None:
        """The paper's P_ML [%] of an experiment, whatever the learner; None where it gives none."""
        for _, own, number in self._numbers:
            if replace(own, learner=experiment.learner) == experiment:
                return number
        return None

    @cached_property
    def datasets(self) -> list[tuple[str, str]]:
        """RSO and station set of every dataset that the evaluations and grids are made of, each once."""
        found = [(one.target, one.stations) for one in self.evaluations.values()]
        found += [(rso, one.stations) for grid in self.grids.values() for rso, one in grid.items()]
        return list(dict.fromkeys(found))

    @cached_property
    def _numbers(self) -> list[tuple[str, Experiment, float]]:
        """The paper's numbers of P_ML with our experiments, in the order of its sections."""
        entries, partition = self.study.entry("evaluations"), self.study.entry("partition")
        found = [
            (name, one, entries[name]["published"])
            for name, one in self.evaluations.items()
            if "published" in entries[name]
        ]
        found += [
            (f"partition_{ratio}", self.partition(ratio), partition["published"][str(ratio)])
            for ratio in partition.get("shown", [])
            if str(ratio) in partition.get("published", {})
        ]
        return sorted(found, key=lambda number: section_of(number[1]))

    @cached_property
    def headlines(self) -> list[Headline]:
        """The paper's numbers with what ours is held against."""
        return [self._headline(*number) for number in self._numbers]

    def _headline(self, name: str, own: Experiment, published: float) -> Headline:
        return Headline(
            name=name,
            experiment=own,
            published=published,
            over_splits=self.study.split_spread(own),
            over_noise=self.study.noise_spread(own),
            fixed=self._fixed(own),
            alternatives=self._alternatives(name, own),
        )

    def _fixed(self, experiment: Experiment) -> Experiment:
        """An experiment with the learner whose kernel scale is one fixed number."""
        return replace(experiment, learner=self.study.entry("reproduction")["fixed"])

    def _alternatives(self, name: str, own: Experiment) -> list[tuple[str, Experiment]]:
        """What is run beside a headline's own experiment, each with what it changes."""
        found = [(text, of[name]) for text, of in self.readings.items() if name in of]
        for one in [self._fixed(own), *self.kernel_scales]:
            if replace(one, learner=own.learner) == own:
                text = f"the kernel scale is {self.kernel_scale(one):g}, not the default rule's"
                found.append((text, one))
        return found

    def kernel_scale(self, experiment: Experiment) -> float:
        """The fixed kernel scale of an experiment's learner."""
        return float(naming.parse_learner(experiment.learner, self.study.learners)["kernel_scale"])

    @cached_property
    def readings(self) -> dict[str, dict[str, Experiment]]:
        """By a reading's text and the headline, the experiments that show a reading's effect.

        The partition is left out: its curve is the same experiment as the test with all stations.
        """
        entries = self.study.entry("reproduction").get("readings", {})
        shown = {name for name, _, _ in self._numbers}
        return {
            entry["text"]: {
                key: read
                for key, own in self.evaluations.items()
                if key in shown and (read := self._read(entry, own)) != own
            }
            for entry in entries.values()
        }

    def _read(self, entry: Mapping[str, Any], experiment: Experiment) -> Experiment:
        """An experiment under another reading of what the paper leaves open."""
        read, own = experiment, self.study.cleaning.previous
        if "learner" in entry:
            read = replace(read, learner=entry["learner"])
        if entry.get("previous", own) != own:
            read = replace(read, reading=naming.READINGS[entry["previous"]])
        if "split" in entry:
            read = replace(read, train=re.sub("^(random|grouped)-", f"{entry['split']}-", read.train))
        if entry.get("windows") == "unseen":
            read = replace(read, test=naming.unseen_test(read.test))
        fence = fence_of(entry.get("fence", "dataset"))
        standardisation = entry.get("standardisation", "training")
        return replace(read, test=naming.treat_test(read.test, fence=fence, standardisation=standardisation))

    @cached_property
    def drawn(self) -> dict[str, Experiment]:
        """Every experiment whose number is drawn, by the figure and the point."""
        found = dict(self.evaluations)
        for ratio in self.study.entry("partition").get("ratios", []):
            found[f"partition_curve, {ratio} %"] = self.partition(ratio)
        for name, grid in self.grids.items():
            found |= {f"{name}_{rso}": one for rso, one in grid.items()}
        for name, curve in self.curves.items():
            found |= {f"{name}_curve, {one.target}, {one.test}": one for one in curve.experiments}
        return found

    @cached_property
    def reported(self) -> list[Experiment]:
        """Every experiment whose number stands in the reproduction, each once."""
        found = [*self.evaluations.values(), *self.partitions, *self.kernel_scales, *self.drawn.values()]
        for headline in self.headlines:
            found += [headline.experiment, headline.fixed, *headline.over_splits, *headline.over_noise]
        for of in self.readings.values():
            found += of.values()
        return list(dict.fromkeys(found))

    @cached_property
    def reproduction(self) -> Reproduction:
        """What the document of the paper's numbers beside ours tells."""
        entry = self.study.entry("reproduction")
        own = self.study.learners[self.study.defaults["learner"]]
        return Reproduction(
            headlines=self.headlines,
            readings=self.readings,
            evaluations=self.evaluations,
            scales={one: self.kernel_scale(one) for one in self.kernel_scales},
            claims=self.claims,
            drawn=self.drawn,
            rule=str(own["kernel_scale"]),
            fixed_scale=float(self.study.learners[entry["fixed"]]["kernel_scale"]),
            calibrated=entry["calibrated"],
        )

    @cached_property
    def claims(self) -> list[Claim]:
        """What the paper says in words, entry by entry, with the experiments that tell."""
        found = []
        for name, entry in self.study.entry("evaluations").items():
            for claim in entry.get("claims", []):
                names = [*claim.get("beside", []), name]
                found.append(self._claim(claim, {one: self.evaluations[one] for one in names}))
        partition = self.study.entry("partition")
        points = {f"{ratio} %": self.partition(ratio) for ratio in partition.get("ratios", [])}
        found += [self._claim(claim, points) for claim in partition.get("claims", [])]
        for name, entry in self.study.entry("grids").items():
            found += [self._claim(claim, self.grids[name]) for claim in entry.get("claims", [])]
        for name, entry in self.study.entry("curves").items():
            found += [self._curve_claim(name, claim) for claim in entry.get("claims", [])]
        individual = self.study.entry("individual")
        found += [
            self._claim(c, {individual["evaluation"]: self.individual}) for c in individual.get("claims", [])
        ]
        return found

    def _curve_claim(self, name: str, claim: Mapping[str, Any]) -> Claim:
        unit = {"inclination": "deg", "semi_major_axis": "km"}[name]
        first = self.curves[name].first
        points = {
            f"{value:g} {unit}": first[value] for value in sorted(first) if value > claim.get("beyond", -1e9)
        }
        return self._claim(claim, points)

    def _claim(self, claim: Mapping[str, Any], points: Mapping[str, Experiment]) -> Claim:
        limits = {key: claim[key] for key in ("limit", "share", "start") if key in claim}
        return Claim(claim["says"], claim["holds"], points, **limits)
