"""Check that the sources of an environment cover a run, before any job starts."""

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.dynamics.settings import ForceModelSettings
from opml.environment import earth_orientation, gravity_field, known_weather, nodes, solar_activity
from opml.study.settings.model.whole import RunSettings


def check(run: RunSettings, *, is_measured: bool = False) -> None:
    """Raise InputError where a source is unreadable, ends before the run, or lacks a degree of a force model.

    is_measured: whether measurements of any object are real
    """
    epoch, sources = run.epoch, run.environment
    ends = nodes(epoch, DAY * run.duration_days)[[0, -1]]
    earth_orientation.tabulate(epoch, ends)
    activities = {"true_solar_activity": sources.true_solar_activity}
    # Measurements before a forecast need not reach into the days ahead.
    if sources.knowledge != known_weather.FORECAST or not (is_measured or sources.true_solar_activity):
        activities = {"solar_activity": sources.solar_activity, **activities}
    for setting, source in activities.items():
        if source:
            _check_activity(setting, source, epoch, ends, sources.percentile)
    _check_knowledge(run, ends)
    field = gravity_field.read_icgem(gravity_field.resolve(sources.gravity_field)).freeze(epoch)
    for name, model in (("truth", run.force_models.truth), ("assumed", run.force_models.assumed)):
        field.truncate(model.degree, model.order)
        _check_tides(name, model, field.tide_system)


def _check_knowledge(run: RunSettings, ends: np.ndarray) -> None:
    """Raise InputError where the sources lack the weather that the assumed model is to know."""
    sources, epoch = run.environment, run.epoch
    kind, source = sources.knowledge, sources.solar_activity
    try:
        if kind == known_weather.MONTHLY:
            known_weather.check_monthly(source)
        if kind == known_weather.HINDCAST:
            known_weather.hindcast(source, epoch, ends)
        if kind == known_weather.FORECAST:
            known_weather.check(source, epoch, ends)
    except InputError as error:
        raise InputError(f"environment.knowledge: {kind}: {error}") from None


def _check_tides(name: str, model: ForceModelSettings, tide_system: str) -> None:
    if "solid_tides" in model.forces:
        try:
            gravity_field.check_tide_system(tide_system)
        except InputError as error:
            raise InputError(f"force_models.{name}.forces: {error}") from None


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
