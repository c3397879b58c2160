"""Whether the data behind an environment reach as far as a run asks, known before any job starts."""

from collections.abc import Mapping
from typing import Any

from opml.environment import earth_orientation, ephemerides, gravity_field, nodes, solar_activity

FETCHED = "EIGEN-6S"
"""The gravity field that only its own rule may fetch; its degree is checked there."""


def check(values: Mapping[str, Any]) -> None:
    """Raise InputError where a source is unreadable, ends before the run does, or lacks a degree asked for.

    `values` are the validated settings.
    """
    epoch, sources = values["epoch"], values["environment"]
    ends = nodes(epoch, 86400.0 * values["duration_days"])[[0, -1]]
    earth_orientation.tabulate(epoch, ends)
    ephemerides.tabulate(sources["ephemerides"], epoch, ends)
    for activity in ("solar_activity", "true_solar_activity"):
        if activity in sources:
            solar_activity.tabulate(sources[activity], epoch, ends, sources["percentile"])
    if sources["gravity_field"] != FETCHED:
        field = gravity_field.read_icgem(gravity_field.resolve(sources["gravity_field"])).at(epoch)
        for model in values["force_models"].values():
            field.truncated(model["degree"], model["order"])
