"""The experiments beyond the paper's: models against splits, other RSOs, RSOs left out, intervals.

As in `experiments`, every function takes the settings' values and returns names only.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from opml import experiments, naming
from opml.experiments import Experiment, Values
from opml.sheets import Rso


def splits(values: Values) -> dict[tuple[str, str, str], Experiment]:
    """Return the experiments by station set, learner and split."""
    entry = _entry(values)
    return {
        (stations, learner, split): experiments.evaluation(
            values, {"stations": stations, "learner": learner, "train": train, "test": test}
        )
        for stations in entry["station_sets"]
        for learner in entry["learners"]
        for split, (train, test) in entry["splits"].items()
    }


def transfers(values: Values, sheet: Mapping[str, Rso]) -> dict[tuple[str, str, str], Experiment]:
    """Return the experiments of one model on other RSOs, by curve, learner and target."""
    entry = _entry(values)["transfers"]
    return {
        (curve, learner, target): experiments.evaluation(
            values, {"learner": learner, "train": entry["train"], "test": entry["test"], "target": target}
        )
        for curve in values["experiments"]["curves"]
        for learner in entry["learners"]
        for target in experiments.targets(values, curve, sheet)
    }


def left_out(values: Values) -> dict[tuple[str, str, str], Experiment]:
    """Return the experiments on an RSO left out of its pool, by pool, learner and that RSO."""
    entry = _entry(values)["transfers"]
    return {
        (pool, learner, rso): experiments.evaluation(
            values,
            {
                "learner": learner,
                "rso": f"{pool}{naming.WITHOUT}{rso}",
                "train": entry["train"],
                "target": rso,
                "test": entry["test"],
            },
        )
        for pool, rsos in values["pools"].items()
        for learner in entry["learners"]
        for rso in rsos
    }


def intervals(values: Values) -> dict[tuple[str, str, str], Experiment]:
    """Return those experiments of `splits` whose prediction intervals are made."""
    entry = _entry(values)["intervals"]
    return {
        key: one
        for key, one in splits(values).items()
        if key[1] in entry["learners"] and key[2] in entry["splits"]
    }


def budget(values: Values) -> dict[tuple[str, str], Experiment]:
    """Return the experiments that take the error apart, by station set and learner. They need the truth."""
    entry = _entry(values)
    train, test = entry["budget"]["split"]
    return {
        (stations, learner): experiments.evaluation(
            values, {"stations": stations, "learner": learner, "train": train, "test": test}
        )
        for stations in entry["station_sets"]
        for learner in entry["budget"]["learners"]
    }


def published(values: Values, experiment: Experiment) -> float | None:
    """Return the paper's P_ML [%] of an experiment, whatever the learner; None where it gives none."""
    for headline in experiments.headlines(values):
        if replace(headline.experiment, learner=experiment.learner) == experiment:
            return headline.published
    return None


def every(values: Values, sheet: Mapping[str, Rso]) -> list[Experiment]:
    """Return every experiment whose P_ML stands in the document, each once."""
    parts = (splits(values), transfers(values, sheet), left_out(values), budget(values))
    return list(dict.fromkeys(one for part in parts for one in part.values()))


def _entry(values: Values) -> Mapping[str, Any]:
    return values["experiments"]["generalisation"]
