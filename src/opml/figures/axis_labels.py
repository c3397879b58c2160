"""Words of the figures: how components, experiments, splits and the space weather are written."""

import math
from collections.abc import Mapping, Sequence

from opml import naming
from opml.figures.display_names import describe_run, display_learner, display_rso
from opml.naming import Experiment, Split

PAPER = "Peng & Bai"  # the paper, in the labels of its numbers

P_ML = r"$P_{\mathrm{ML}}$"

INTERVAL = "bars: 5th to 95th percentile over resampled estimates"  # note on the bars of P_ML
NO_CORRECTION = 100.0  # P_ML [%] without a correction

VARIED = {
    "inclination": "inclination $i$ [deg]",
    "semi_major_axis": "increment of the semi-major axis $a$ [km]",
}
"""The element that RSOs of a curve differ in, by the curve's name."""

DIRECTIONS = {"x": "radial", "y": "along-track", "z": "cross-track"}  # axes of RSW in words

ASIDE = {"rest": "the rest", "seen": "the same rows"}


def axis(component: str) -> str:
    """Return the component's axis, `y` of `e_y`."""
    return component.removeprefix("e_")


def symbol(component: str) -> str:
    """Return the component as the paper writes it."""
    return rf"$e_{{{axis(component)}}}$"


def in_words(component: str) -> str:
    """Return what a component is an error of: `along-track error` of `e_y`."""
    moving = axis(component)
    return f"{DIRECTIONS[moving[-1]]} {'velocity ' if moving.startswith('v') else ''}error"


def size_label(component: str, unit_name: str) -> str:
    """Return the label of an axis of sizes of an error: `along-track error |e_y| [km]`."""
    return f"{in_words(component)} $|e_{{{axis(component)}}}|$ [{unit_name}]"


def unit(component: str) -> tuple[str, float]:
    """Return the unit a component is drawn in, and its number per SI unit: km and 1e-3, or m/s and 1."""
    return ("m/s", 1.0) if axis(component).startswith("v") else ("km", 1e-3)


def si_unit(component: str) -> str:
    """Return the SI unit of a component."""
    return "m/s" if axis(component).startswith("v") else "m"


def describe_training(name: str) -> str:
    """Return in words the rows that a training split names: `80 % of the estimates`, `days 0 to 30`."""
    split = naming.parse_train(naming.strip_seed(name, naming.SPLIT))
    if split.kind == "days":
        return _days(split)
    return f"{split.percent:g} % of the " + ("estimates" if split.kind == "grouped" else "predictions")


def describe_test(name: str) -> str:
    """Return in words the rows that a test names, and how it treats them: `the rest`, `days 30 to 40`."""
    split = naming.parse_test(name)
    words = [_days(split) if split.kind == "days" else ASIDE[split.kind]]
    if split.starts_inside:
        words.append("new estimates only")
    if split.fence is not None:
        words.append("no fences" if math.isinf(split.fence) else "fences of its own")
    return ", ".join(words)


def describe_experiment(experiment: Experiment) -> str:
    """Return as a line what one model was trained and tested on."""
    rso, target = display_rso(experiment.rso), display_rso(experiment.target)
    where = "" if target == rso else f"{target.removeprefix(f'{rso}, ')}, "
    trained = f"{display_learner(experiment.learner)} trained on {describe_training(experiment.train)}"
    run = describe_run(experiment.rso, experiment.stations)
    return f"{run}; {trained}, tested on {where}{describe_test(experiment.test)}"


def describe_splits(pairs: Mapping[str, Sequence[str]]) -> str:
    """Return as a line what splits train and test on; pairs: names of both by the split's name."""
    return "; ".join(
        f"{name}: trained on {describe_training(train)}, tested on {describe_test(test)}"
        for name, (train, test) in pairs.items()
    )


def lines(*parts: str) -> str:
    """Return the parts that are not empty, a line each."""
    return "\n".join(filter(None, parts))


def clauses(*parts: str) -> str:
    """Return the parts that are not empty in one line, with semicolons between them."""
    return "; ".join(filter(None, parts))


def _days(split: Split) -> str:
    first, last = split.days
    return f"days {first:g} to {last:g}"
