"""The settings of a job: what stands under `settings` in the params of its rule, as typed attributes."""

from collections.abc import Mapping, Sequence
from typing import Any

Values = Mapping[str, Any]
"""A mapping of settings that a value of the package is made of, such as `Rso` or `Estimation`."""


class JobSettings:
    """Settings of a job that makes tables; a job has those that its rule gives.

    values: the same as a mapping, for functions that read several
    """

    epoch: str  # UTC
    duration_days: float
    max_days: float
    step_s: float
    window_hours: float
    after_hours: float
    memory_days: float
    span_days: Sequence[float]
    known_until_days: float
    train_days: Sequence[float]
    every_hours: float
    issue_hours: int
    seed: int
    noise: int
    rso: Values
    rsos: Sequence[Values]
    stations: Sequence[Values]
    estimation: Values
    taking: Values
    light_time: bool
    positions_alone: bool
    cleaning: Values
    cd: float
    cd_bounds: Sequence[float] | None
    resonances: Sequence[Sequence[int]]
    long_window_hours: float
    members: int
    level: float
    source: str
    percentile: int
    kernel: str
    degree: int
    order: int
    knowledge: str
    forecast: Values
    learner: Values
    learners: Sequence[Values]
    train: str
    component: str
    experiment: Mapping[str, str]
    intervals: Values
    rolling: Values
    manoeuvres: Sequence[str]
    table: str
    weather: str
    latency_hours: float
    seasons: Mapping[str, Sequence[str]]
    seasons_of_tests: Mapping[str, Mapping[str, Sequence[str]]]
    teachers: Mapping[str, str]
    tests: Sequence[str]
    trials: Sequence[Sequence[str]]

    def __init__(self, values: Values):
        self.values = values
        vars(self).update(values)


class SheetJobSettings(JobSettings):
    """Settings of a job that takes its RSO by its name alone."""

    rso: str  # type: ignore[assignment]  # its name


class FigureSettings(SheetJobSettings):
    """Settings of a job that draws a figure or writes a report; RSOs and station sets are names."""

    stations: str  # type: ignore[assignment]
    learners: Sequence[str]  # type: ignore[assignment]  # their names
    target: str
    test: str
    laws: Sequence[str]
    days: Sequence[float]
    radius_m: float
    threshold: float
    note: str
    published: Any  # by what the figure varies
    splits: Mapping[str, Sequence[str]]
    models: Mapping[str, Values]
    radars: Sequence[Values]
    station_sets: Sequence[str]
    windows: Sequence[str]
    window_day: float
    zoom_days: Sequence[float]
    track: int
    targets: Mapping[str, float]
    rules: Mapping[str, float]
    marks: Sequence[float]
    last_days: float
    every_days: float
    first_day: float
    experiments: Mapping[str, Any]
    evaluations: Sequence[str]
    datasets: Sequence[str]
    curves: Mapping[str, Sequence[str]]
    curve: str
    date: str
    hour: float
