"""The experiments that the settings ask for, each as the names its files have.

Every function takes the settings' values (see config/README.md) and returns names only; nothing is read or
computed here, so that the plan of a run is known before it starts.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from opml import naming
from opml.sheets import Rso
from opml.tables import COMPONENTS

Values = Mapping[str, Any]

WINDOW = "days-"
SECTIONS = {
    "simulation": "2 Simulation Environment",
    "learning": "3 Prediction Accuracy Improvement through Machine Learning",
    "numerical": "4 Numerical Results of Improving Orbit Prediction",
    "future": "5 Generalize the SVM Model to Future Epochs",
    "nearby": "6 Generalization to Nearby RSOs",
    "beyond": "7 Beyond the paper",
}
"""The paper's sections, numbered as it prints them."""


@dataclass(frozen=True)
class Experiment:
    """One model applied to one test: the parts of its files' names."""

    rso: str
    stations: str
    train: str
    learner: str
    component: str
    target: str
    test: str
    reading: str = ""
    window: str = ""

    def names(self) -> dict[str, str]:
        """Return the wildcards by name."""
        return asdict(self)

    @property
    def section(self) -> str:
        """The paper's section that such an experiment belongs to."""
        if self.target != self.rso:
            return SECTIONS["nearby"]
        return SECTIONS["future" if self.test.startswith(WINDOW) else "numerical"]


@dataclass(frozen=True)
class Headline:
    """A number that the paper states, and the experiment that gives ours."""

    name: str
    experiment: Experiment
    published: float


def evaluation(values: Values, entry: Mapping[str, Any]) -> Experiment:
    """Return the experiment of an entry; what it leaves out are the defaults, and its own RSO as target."""
    named = _defaults(values) | {key: entry[key] for key in entry if key in Experiment.__dataclass_fields__}
    return Experiment(**({"target": named["rso"]} | named))


def evaluations(values: Values) -> dict[str, Experiment]:
    """Return the experiments that have figures of their own, by the figures' name, in the paper's order."""
    found = {name: evaluation(values, entry) for name, entry in _entries(values, "evaluations").items()}
    return dict(sorted(found.items(), key=lambda item: item[1].section))


def partition(values: Values, ratio: int) -> Experiment:
    """Return the test on the rest after training on `ratio` % of the rows."""
    return evaluation(
        values, {**values["experiments"]["partition"], "train": f"random-{ratio}", "test": "rest"}
    )


def partitions(values: Values) -> list[Experiment]:
    """Return the partition curve's experiments, of all seeds that are drawn."""
    ratios = values["experiments"]["partition"]["ratios"]
    return [one for ratio in ratios for one in drawn_seeds(values, partition(values, ratio))]


def grid(values: Values, name: str) -> dict[str, Experiment]:
    """Return a grid's experiments by RSO, each trained on itself."""
    entry = _entries(values, "grids")[name]
    return {rso: evaluation(values, {**entry, "rso": rso}) for rso in entry["rsos"]}


def targets(values: Values, curve: str, sheet: Mapping[str, Rso]) -> dict[str, float]:
    """Return a curve's RSOs and what is varied: the inclination [deg] or what is added to the axis [km]."""
    entry = _entries(values, "curves")[curve]
    rso = evaluation(values, {**entry, "test": ""}).rso
    if curve == "inclination":
        return {naming.with_inclination(rso, value, sheet): value for value in entry["inclinations"]}
    return {naming.with_offset(rso, value, sheet): value for value in entry["offsets"]}


def curve(values: Values, name: str, sheet: Mapping[str, Rso]) -> list[Experiment]:
    """Return the experiments of a curve over other RSOs, of all seeds that are drawn."""
    entry = _entries(values, "curves")[name]
    return [
        one
        for test in entry["tests"]
        for target in targets(values, name, sheet)
        for one in drawn_seeds(values, evaluation(values, {**entry, "test": test, "target": target}))
    ]


def kernel_scales(values: Values) -> list[Experiment]:
    """Return the experiments with one fixed kernel scale each: every scale, split and station set."""
    entry = values["experiments"]["kernel_scale"]
    learner = evaluation(values, {**entry, "train": "", "test": ""}).learner
    return [
        _kernel_scale(values, stations, split, f"{learner}_s{naming.number(scale)}")
        for stations in entry["station_sets"]
        for split in entry["splits"]
        for scale in entry["scales"]
    ]


def kernel_rules(values: Values) -> list[Experiment]:
    """Return the experiments whose models tell the scales of the rules: the first split, each station set."""
    entry = values["experiments"]["kernel_scale"]
    split = entry["splits"][0]
    return [
        _kernel_scale(values, stations, split, learner)
        for stations in entry["station_sets"]
        for learner in entry["rules"]
    ]


def all_components(values: Values) -> dict[str, list[Experiment]]:
    """Return the experiments of the table of components, by evaluation."""
    known = evaluations(values)
    return {
        name: [replace(known[name], component=component) for component in COMPONENTS]
        for name in values["experiments"]["components"]
    }


def headlines(values: Values) -> list[Headline]:
    """Return the paper's numbers of P_ML with our experiments, in the order of its sections."""
    entries, entry = _entries(values, "evaluations"), values["experiments"]["partition"]
    found = [
        Headline(name, experiment, entries[name]["published"])
        for name, experiment in evaluations(values).items()
        if "published" in entries[name]
    ]
    found += [
        Headline(f"partition_{ratio}", partition(values, ratio), entry["published"][str(ratio)])
        for ratio in entry["shown"]
        if str(ratio) in entry["published"]
    ]
    return sorted(found, key=lambda headline: headline.experiment.section)


def drawn_seeds(values: Values, experiment: Experiment) -> list[Experiment]:
    """Return an experiment under all pairs of the seeds that curves are drawn with."""
    seeds = values["experiments"]["seeds"]
    return [
        with_seeds(values, experiment, noise=noise, split=split)
        for noise in seeds["noise"]
        for split in seeds["split"]
    ]


def split_spread(values: Values, experiment: Experiment) -> list[Experiment]:
    """Return an experiment under the split seeds that its spread is stated over."""
    seeds = values["experiments"]["seeds"]["spread"]["split"]
    return [with_seeds(values, experiment, split=seed) for seed in seeds]


def noise_spread(values: Values, experiment: Experiment) -> list[Experiment]:
    """Return an experiment under the noise seeds that its spread is stated over.

    Empty for a transfer to another RSO: it would need that RSO measured anew under each seed.
    """
    if experiment.target != experiment.rso:
        return []
    seeds = values["experiments"]["seeds"]["spread"]["noise"]
    return [with_seeds(values, experiment, noise=seed) for seed in seeds]


def with_seeds(
    values: Values, experiment: Experiment, *, noise: int | None = None, split: int | None = None
) -> Experiment:
    """Return an experiment under other seeds; None is the run's own."""
    own = values["seed"]
    noise, split = own["noise"] if noise is None else noise, own["split"] if split is None else split
    return replace(
        experiment,
        stations=naming.seeded(experiment.stations, naming.NOISE, noise, default=own["noise"]),
        train=naming.seeded(experiment.train, naming.SPLIT, split, default=own["split"]),
    )


def fixed(values: Values, experiment: Experiment) -> Experiment:
    """Return an experiment with the learner whose kernel scale is one fixed number."""
    return replace(experiment, learner=values["experiments"]["reproduction"]["fixed"])


def reading(values: Values, name: str, experiment: Experiment) -> Experiment | None:
    """Return an experiment under another reading of what the paper leaves open, None where they agree."""
    entry = values["experiments"]["reproduction"]["readings"][name]
    read = experiment
    if "learner" in entry:
        read = replace(read, learner=entry["learner"])
    if entry.get("previous", values["cleaning"]["previous"]) != values["cleaning"]["previous"]:
        read = replace(read, reading=naming.READINGS[entry["previous"]])
    if "split" in entry:
        read = replace(read, train=re.sub("^(random|grouped)-", f"{entry['split']}-", read.train))
    if entry.get("windows") == "unseen" and re.fullmatch(r"days-[0-9.]+-[0-9.]+", read.test):
        read = replace(read, test=f"{read.test}-unseen")
    return None if read == experiment else read


def readings(values: Values) -> dict[str, dict[str, Experiment]]:
    """Return by reading and headline the experiments that show a reading's effect.

    The partition is left out: its curve is the same experiment as the test with all stations.
    """
    known, shown = evaluations(values), [headline.name for headline in headlines(values)]
    return {
        name: {
            key: read
            for key, experiment in known.items()
            if key in shown and (read := reading(values, name, experiment))
        }
        for name in values["experiments"]["reproduction"]["readings"]
    }


def reported(values: Values, sheet: Mapping[str, Rso]) -> list[Experiment]:
    """Return every experiment whose number stands in the reproduction."""
    found = [*evaluations(values).values(), *partitions(values), *kernel_scales(values)]
    for name in values["experiments"]["grids"]:
        found += grid(values, name).values()
    for name in values["experiments"]["curves"]:
        found += curve(values, name, sheet)
    for headline in headlines(values):
        own = headline.experiment
        found += [own, fixed(values, own), *split_spread(values, own), *noise_spread(values, own)]
    for of in readings(values).values():
        found += of.values()
    return list(dict.fromkeys(found))


def _kernel_scale(values: Values, stations: str, split: Sequence[str], learner: str) -> Experiment:
    entry = {**values["experiments"]["kernel_scale"], "stations": stations, "learner": learner}
    return evaluation(values, {**entry, "train": split[0], "test": split[1]})


def _defaults(values: Values) -> dict[str, str]:
    return dict(values["experiments"]["defaults"])


def _entries(values: Values, kind: str) -> Mapping[str, Mapping[str, Any]]:
    return values["experiments"][kind]
