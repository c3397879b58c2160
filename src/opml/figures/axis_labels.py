"""How an error component and an experiment are written in a figure."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from opml import naming
from opml.naming import Split

ASIDE = {"rest": "the rest", "seen": "the same rows"}
STANDARDISED = {"own": "standardised alone", "together": "standardised with the training"}


def axis(component: str) -> str:
    """The component's axis, `y` of `e_y`."""
    return component.removeprefix("e_")


def symbol(component: str) -> str:
    """The component as the paper writes it."""
    return rf"$e_{{{axis(component)}}}$"


def unit(component: str) -> tuple[str, float]:
    """The unit a component is drawn in, and how many of it one SI unit is: positions km, velocities m/s."""
    return ("m/s", 1.0) if axis(component).startswith("v") else ("km", 1e-3)


def trained(name: str) -> str:
    """The rows that a training split names, in words: `80 % of the estimates`, `days 0 to 30`."""
    split = naming.parse_train(naming.strip_seed(name, naming.SPLIT))
    if split.kind == "days":
        return _days(split)
    return f"{split.percent:g} % of the " + ("estimates" if split.kind == "grouped" else "predictions")


def tested(name: str) -> str:
    """The rows that a test names, in words: `the rest`, `days 30 to 40`, with how it treats them."""
    split = naming.parse_test(name)
    words = [_days(split) if split.kind == "days" else ASIDE[split.kind]]
    if split.unseen:
        words.append("new estimates only")
    if split.fence is not None:
        words.append("no fences" if math.isinf(split.fence) else "fences of its own")
    if split.standardisation != "training":
        words.append(STANDARDISED[split.standardisation])
    return ", ".join(words)


def experiment(
    *, rso: str, stations: str, train: str, learner: str, target: str, test: str, **_: object
) -> str:
    """What one model was trained and tested on, as a line of a figure."""
    where = "" if target == rso else f"{target}, "
    return f"{rso} by {stations}; {learner} trained on {trained(train)}, tested on {where}{tested(test)}"


def with_weather(note: str, settings: Mapping[str, Any]) -> str:
    """A line of a figure, and below it what is known of the space weather, where the settings say."""
    return "\n".join(filter(None, [note, settings.get("weather")]))


def splits(pairs: Mapping[str, Sequence[str]]) -> str:
    """What splits of these names train and test on, as a line of a figure."""
    return "; ".join(
        f"{name}: trained on {trained(train)}, tested on {tested(test)}"
        for name, (train, test) in pairs.items()
    )


def _days(split: Split) -> str:
    first, last = split.days
    return f"days {first:g} to {last:g}"
