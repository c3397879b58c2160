"""Params of jobs: the settings that the wildcards of a file's name choose."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Protocol

from opml import naming
from opml.base.errors import InputError
from opml.base.section import Section
from opml.catalog import kinds
from opml.environment import known_weather
from opml.learning.data import error_components
from opml.learning.data.dataset import MEASUREMENT
from opml.learning.models.contract import ResolvedSettings
from opml.naming import Experiment
from opml.orbits import sheets
from opml.study.settings.model.whole import RunSettings
from opml.workflow.plan import Plan


class Wildcards(Protocol):
    """The parts of a file's name, as Snakemake hands them to functions of rules."""

    def __getattr__(self, name: str) -> str: ...

    def items(self) -> Iterable[tuple[str, str]]:
        """Return names and values."""
        ...


@dataclass(frozen=True)
class Params:
    """Params of jobs; the methods raise InputError for a name that is wrong or impossible."""

    plan: Plan

    @property
    def run(self) -> RunSettings:
        """The settings of the run."""
        return self.plan.settings.run

    @property
    def span(self) -> dict[str, Any]:
        """Epoch and length of the run."""
        return {"epoch": self.run.epoch, "duration_days": self.run.duration_days}

    @property
    def assumed_model(self) -> dict[str, Any]:
        """Epoch, and the force model and integrator of fits and predictions."""
        return {
            "epoch": self.run.epoch,
            "force_model": _given(self.run.force_models.assumed),
            "integrator": _given(self.run.integrator),
        }

    @property
    def true_model(self) -> dict[str, Any]:
        """Epoch, length and step, force model and integrator of truths."""
        return self.span | {
            "step_s": self.run.tracking.step_s,
            "force_model": self.run.force_models.truth.model_dump(),
            "integrator": _given(self.run.integrator),
        }

    @property
    def cd_bounds(self) -> list[float] | None:
        """Bounds on Cd of the estimates that fits start from and means are taken of; None without any."""
        bounds = self.plan.study.cleaning.cd_bounds
        return None if bounds is None else list(bounds)

    def rso_named(self, name: str) -> dict[str, Any]:
        """Return the elements and the body of an RSO by its name."""
        return asdict(sheets.parse_rso(name, self.plan.settings.rsos))

    def rso(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return the elements and the body of the wildcard `rso`."""
        return self.rso_named(wildcards.rso)

    @property
    def all_stations(self) -> list[dict[str, Any]]:
        """All stations of the run."""
        return [station.row for station in self.plan.settings.stations.values()]

    def stations(self, wildcards: Wildcards) -> list[dict[str, Any]]:
        """Return the stations of the wildcard `stations`; none where it stands for none of the sheet."""
        if wildcards.stations in kinds.in_place_of_stations():
            return []
        names = naming.strip_seed(wildcards.stations, naming.NOISE)
        return [station.row for station in sheets.parse_stations(names, self.plan.settings.stations)]

    def noise_seed(self, wildcards: Wildcards) -> int:
        """Return the seed of the measurement noise, which the wildcard `stations` may end in."""
        default = self.plan.settings.run.seed.noise
        return naming.parse_seed(wildcards.stations, naming.NOISE, default=default)[1]

    def window_hours(self, wildcards: Wildcards) -> float:
        """Return the hours of tracks that each estimate is made of."""
        return naming.parse_window(wildcards.window, default=self.plan.window_hours)

    def estimation(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return the settings of the fits, with what the suffix of the estimates changes."""
        return _given(self.run.estimation) | {
            "window_hours": self.window_hours(wildcards),
            "cd_bounds": self.cd_bounds,
        }

    def arc(self, wildcards: Wildcards) -> dict[str, float]:
        """Return the window [h] of arcs."""
        return {"window_hours": naming.parse_number(wildcards.arc)}

    def arc_with_past(self, wildcards: Wildcards) -> dict[str, float]:
        """Return window [h] and memory [days] of arcs."""
        return self.arc(wildcards) | {"memory_days": naming.parse_number(wildcards.memory)}

    def cleaning(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return the settings of the cleaning, with the reading of t_b that the wildcards ask for."""
        study = self.plan.study
        previous = naming.parse_reading(wildcards.reading, previous=study.cleaning.previous)
        return dict(study.entry("cleaning")) | {"previous": previous}

    def learner(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return the settings of the wildcard `learner` with its variables, as jobs have them."""
        return self.resolved(wildcards).of_job()

    def resolved(self, wildcards: Wildcards) -> ResolvedSettings:
        """Return the settings of the wildcard `learner` with its variables."""
        return self._resolved(wildcards.learner, dict(wildcards.items()))

    def _resolved(self, name: str, parts: Mapping[str, str]) -> ResolvedSettings:
        learner = naming.parse_learner(name, self.plan.study.learners)
        component = parts.get("component", error_components.CORRECTED)
        variables: list[str] = self.run.learning.variables
        if "stations" in parts and not self.plan.settings.are_radars(parts["stations"]):
            variables = [name for name in variables if name not in MEASUREMENT]  # no radar measured them
        return learner.resolved(component=component, variables=variables)

    def options(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return how what was measured of the wildcard `rso` is taken."""
        return self._measured(wildcards.rso)["options"]

    def _measured(self, rso: str) -> dict[str, Any]:
        settings = self.plan.settings
        kind = settings.kind_of(rso)
        if kind is None:
            raise InputError(f"{rso}: expected an RSO that has {kinds.names()}")
        # The files of ranges' stations are inputs of their job.
        options = settings.options(kind, rso).model_dump(
            exclude={"coordinates", "eccentricities"}, exclude_none=True
        )
        return {"kind": kind.name, "files": settings.files_of(kind)[rso], "options": options}

    def split(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return the training split and its seed."""
        default = self.plan.settings.run.seed.split
        train, seed = naming.parse_seed(wildcards.train, naming.SPLIT, default=default)
        naming.check_split(naming.parse_train(train), duration_days=self.run.duration_days)
        return {"train": train, "seed": seed}

    def training(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return the params of all jobs that split a dataset: epoch, split, seed and span."""
        return {"epoch": self.run.epoch, **self.split(wildcards), "span_days": self.plan.study.span_days}

    def experiment(self, wildcards: Wildcards) -> dict[str, str]:
        """Return the experiment in the columns of `metrics`."""
        experiment = Experiment(**dict(wildcards.items()))
        naming.check_split(naming.parse_test(experiment.test), duration_days=self.run.duration_days)
        if experiment.test == "seen" and experiment.rso != experiment.target:
            expected = f"expected the RSO that was trained on, {experiment.rso}"
            raise InputError(f"split 'seen': {expected}, got {experiment.target}")
        return experiment.columns()

    def check_simulated(self, wildcards: Wildcards) -> None:
        """Raise InputError for the truth of an RSO that was measured, and that no orbit of files judges."""
        if wildcards.rso in self.plan.settings.measured and wildcards.rso not in self.plan.settings.orbits:
            known = "what was measured has no truth, and no seed of the noise"
            raise InputError(
                f"truth of '{wildcards.rso}': expected an RSO without own measurements, as {known}"
            )

    def mornings_of(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return the params of the mornings of the wildcard `batch`, up to the wildcard `date`."""
        day, elements = self.plan.settings.day, self.plan.settings.files_of(kinds.ELEMENTS)
        models = {name: self._resolved(name, {}) for name in self.plan.settings.morning_models}
        return {
            **self.assumed_model,
            "duration_days": self.run.duration_days,
            "date": wildcards.date,
            "hour": day.hour,
            "days": self.plan.product("days").folder,
            "batch": wildcards.batch,
            "stations": self.all_stations,
            "estimation": _given(self.run.estimation),
            "max_days": self.run.prediction.max_days,
            "step_s": day.step_s,
            "models": {name: settings.of_job() for name, settings in models.items()},
            # The catalogue with which each set is improved, and the weather under which it is.
            "element_files": sorted({path for paths in elements.values() for path in paths}),
            "weather": str(known_weather.measured_source(self.run.environment.solar_activity)),
            "passes": day.passes,
            "objects": {rso: self._watched(rso) for rso in self.plan.watched[wildcards.batch]},
        }

    def page_of_day(self, wildcards: Wildcards) -> dict[str, Any]:
        """Return the params of the page of the wildcard `date`."""
        return {"epoch": self.run.epoch, "hour": self.plan.settings.day.hour, "date": wildcards.date}

    def _watched(self, rso: str) -> dict[str, Any]:
        settings = self.plan.settings
        return {
            "rso": self.rso_named(rso),
            **self._measured(rso),
            "start": settings.starts.get(rso, ""),
            "manoeuvres": settings.manoeuvres(rso),
            "has_message": settings.day.messages is None or rso in settings.day.messages,
        }

    def errors(self, experiment: Experiment, **more: Any) -> dict[str, Any]:
        """Return the params of a figure of errors: epoch, cleaning, parts of the experiment's name."""
        return {
            "epoch": self.run.epoch,
            "cleaning": dict(self.plan.study.entry("cleaning")),
            "experiment": experiment.names(),
            **more,
        }


def _given(section: Section) -> dict[str, Any]:
    return section.model_dump(exclude_unset=True, by_alias=True)
