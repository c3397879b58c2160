"""Check that the sources of an environment cover a run, before any job starts."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.environment import (
    celestial_bodies,
    earth_orientation,
    gravity_field,
    knowledge,
    nodes,
    nrlmsis,
    solar_activity,
)

FETCHED = "EIGEN-6S"
"""The gravity field that only the workflow's rule may fetch; the rule checks its degree."""


def check(values: Mapping[str, Any], *, is_measured: bool = False) -> None:
    """Raise InputError where a source is unreadable, ends before the run, or lacks a degree of a force model.

    values: the validated settings
    is_measured: whether measurements of any object are real
    """
    epoch, sources = values["epoch"], values["environment"]
    ends = nodes(epoch, DAY * values["duration_days"])[[0, -1]]
    earth_orientation.tabulate(epoch, ends)
    celestial_bodies.tabulate(sources["ephemerides"], epoch, ends)
    flown = ["solar_activity", "true_solar_activity"]
    if sources.get("knowledge") == knowledge.FORECAST and (is_measured or flown[1] in sources):
        flown.remove("solar_activity")  # measurements before a forecast need not reach into the days ahead
    for setting in flown:
        if setting in sources:
            _check_activity(setting, sources[setting], epoch, ends, sources["percentile"])
    _check_knowledge(values, ends)
    _check_atmosphere(values, ends)
    if sources["gravity_field"] != FETCHED:
        field = gravity_field.read_icgem(gravity_field.resolve(sources["gravity_field"])).freeze(epoch)
        for name, model in values["force_models"].items():
            field.truncate(model["degree"], model["order"])
            _check_tides(name, model, field.tide_system)


def _check_knowledge(values: Mapping[str, Any], ends: np.ndarray) -> None:
    """Raise InputError where the sources lack the weather that the assumed model is to know."""
    sources = values["environment"]
    kind, source = sources.get("knowledge"), sources["solar_activity"]
    try:
        if kind == knowledge.MONTHLY:
            knowledge.check_monthly(source)
        if kind == knowledge.HINDCAST:
            knowledge.hindcast(source, values["epoch"], ends)
        if kind == knowledge.FORECAST:
            forecast, hours = values["forecasts"][sources["forecast"]], sources["issue_hours"]
            knowledge.check(source, values["epoch"], ends, forecast=forecast, issue_hours=hours)
    except InputError as error:
        raise InputError(f"environment.knowledge: {kind}: {error}") from None


def _check_atmosphere(values: Mapping[str, Any], ends: np.ndarray) -> None:
    """Raise InputError where the truth is to fly through NRLMSIS without its code or measured weather."""
    sources = values["environment"]
    if values["force_models"]["truth"].get("atmosphere") != nrlmsis.NAME:
        return
    try:
        nrlmsis.check_installed()
        nrlmsis.read_weather(
            sources.get("true_solar_activity", sources["solar_activity"]), values["epoch"], ends
        )
    except InputError as error:
        raise InputError(f"force_models.truth.atmosphere: {nrlmsis.NAME}: {error}") from None


def _check_tides(name: str, model: Mapping[str, Any], tide_system: str) -> None:
    """Raise InputError where a force model is to have tides that the gravity field does not allow."""
    if model.get("solid_tides"):
        try:
            gravity_field.check_tide_system(tide_system)
        except InputError as error:
            raise InputError(f"force_models.{name}.{error}") from None


def _check_activity(setting: str, source: str, epoch: str, ends: np.ndarray, percentile: int) -> None:
    """Raise InputError where a source does not cover the run; for a packaged source, with a remedy."""
    try:
        solar_activity.tabulate(source, epoch, ends, percentile)
    except InputError:
        if source not in solar_activity.PACKAGED:
            raise
        first, last = solar_activity.reach(source)
        begin, end = (epochs.calendar_day(epoch, t) for t in ends)
        raise InputError(
            f"environment.{setting}: {source} reaches from {first} to {last}, "
            f"this run needs {begin} to {end}; for other dates give the path of a bulletin"
        ) from None
