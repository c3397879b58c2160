"""Input functions: the files that a job reads, by the wildcards of what it makes.

Functions and methods that find something return such an input function. They take patterns, which are the
outputs of other rules.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from opml import naming
from opml.base.errors import InputError
from opml.catalog.kinds import ELEMENTS, FIXES, TRACKS
from opml.learning.models import learners
from opml.learning.models.contract import ResolvedSettings
from opml.naming import Experiment
from opml.workflow.params import Params, Wildcards
from opml.workflow.plan import Plan, end_plan

_Paths = str | list[str]
InputFunction = Callable[[Wildcards], _Paths]


class _Pattern(Protocol):
    """The output of a rule, which holds wildcards and knows the storage that it is kept in."""

    def apply_wildcards(self, wildcards: Mapping[str, str]) -> str:
        """Return the path for values of the wildcards."""
        ...


def path_of(pattern: _Pattern, **parts: str) -> str:
    """Return the path of a pattern for values of its wildcards.

    Not by `str.format`, which would lose the storage that the file is kept in.
    """
    return pattern.apply_wildcards(parts)


def paths_of(pattern: _Pattern, *experiments: Experiment) -> list[str]:
    """Return the paths of a pattern for experiments, each once."""
    return list(dict.fromkeys(path_of(pattern, **experiment.names()) for experiment in experiments))


def tables_of(patterns: Mapping[str, _Pattern], *experiments: Experiment) -> dict[str, list[str]]:
    """Return the paths of several patterns for experiments, by the patterns' names."""
    return {
        name: [path_of(pattern, **experiment.names()) for experiment in experiments]
        for name, pattern in patterns.items()
    }


def at_window(window: str, pattern: _Pattern) -> InputFunction:
    """Find a file of estimates that has another suffix for their window."""
    return lambda wildcards: path_of(pattern, **dict(wildcards.items()) | {"window": window})


def target(files: Sequence[str], part: str) -> InputFunction:
    """Find the files of a target; end the plan where there are none.

    part: what the study would have to hold, as its settings call it
    """

    def find(_: Wildcards) -> _Paths:
        if not files:
            end_plan(
                f"study: expected {part} to train and to test on, got none; `opml docs howto` shows a study"
            )
        return list(files)

    return find


def checks(*functions: Callable[[Wildcards], object]) -> InputFunction:
    """Find no file, but end the plan in one line where a function raises InputError.

    functions: each raises InputError for a name that is wrong or impossible
    """

    def check(wildcards: Wildcards) -> _Paths:
        try:
            for function in functions:
                function(wildcards)
        except InputError as error:
            end_plan(error)
        return []

    return check


def _tables_asked(settings: ResolvedSettings) -> list[tuple[str, str]]:
    """Return kind and suffix of the tables beside the dataset that have the variables of a learner."""
    suffixes: dict[str, str] = {}
    if arc := learners.arc_of(settings):
        suffixes["arcs"] = naming.arc_suffix(arc[0])
        suffixes["cd_past"] = suffixes["held"] = suffixes["arcs"] + naming.memory_suffix(arc[1])
    return [(kind, suffixes.get(kind, "")) for kind in learners.tables_asked(settings.variables)]


@dataclass(frozen=True)
class Inputs:
    """Input functions that depend on the settings of a run."""

    plan: Plan
    params: Params

    def activity(self, wildcards: Wildcards) -> str:
        """Return the path of the solar activity that an RSO flew under, or of the assumed one if unknown."""
        environment = self.plan.environment
        tables = (
            environment.predictions if wildcards.rso in self.plan.settings.measured else environment.truth
        )
        return tables["solar_activity"]

    def truth(self, truth: _Pattern) -> InputFunction:
        """Find the truth of an RSO; none where it was measured and no orbit judges."""

        def find(wildcards: Wildcards) -> _Paths:
            has_truth = (
                wildcards.rso not in self.plan.settings.measured or wildcards.rso in self.plan.settings.orbits
            )
            return path_of(truth, rso=wildcards.rso) if has_truth else []

        return find

    def truth_or(self, truth: _Pattern, measured: _Pattern) -> InputFunction:
        """Find the truth of an RSO, or a table in its place where it was measured.

        measured: the table in its place, of an RSO and stations
        """

        def find(wildcards: Wildcards) -> _Paths:
            if wildcards.rso in self.plan.settings.measured:
                return path_of(measured, rso=wildcards.rso, stations=wildcards.stations)
            return path_of(truth, rso=wildcards.rso)

        return find

    def user_manoeuvres(self, truth: _Pattern, tracking: _Pattern) -> InputFunction:
        """Find the table whose metadata hold the manoeuvres of an RSO; no table where it is simulated.

        truth: holds those of an orbit from files
        tracking: holds those of what was measured
        """
        find_any = self.truth_or(truth, tracking)

        def find(wildcards: Wildcards) -> _Paths:
            base, *_ = naming.rso_parts(wildcards.rso, self.plan.settings.rsos)
            return (
                find_any(wildcards)
                if base in {*self.plan.settings.orbits, *self.plan.settings.measured}
                else []
            )

        return find

    def later_estimates(self, estimates: _Pattern) -> InputFunction:
        """Find the later estimates that labels are made of; none where the truth is known."""

        def find(wildcards: Wildcards) -> _Paths:
            if not wildcards.label:
                return []
            return self._estimates(estimates, wildcards, self.params.label_window(wildcards))

        return find

    def true_errors(self, dataset: _Pattern) -> InputFunction:
        """Find the dataset with the true errors behind labels; none without labels or without a truth.

        It is of the RSO under test, where the name has one.
        """

        def find(wildcards: Wildcards) -> _Paths:
            parts = dict(wildcards.items())
            rso = parts.get("target", wildcards.rso)
            if not wildcards.label or not self.plan.study.has_truth(rso):
                return []
            return path_of(dataset, **parts | {"rso": rso})

        return find

    def learner_tables(self, part: str) -> InputFunction:
        """Find the tables beside the dataset that have the variables of learners, learner after learner.

        part: wildcard of the RSO, `rso` or `target`
        """

        def find(wildcards: Wildcards) -> _Paths:
            rso = dict(wildcards.items())[part]
            name = f"{rso}/{wildcards.stations}{wildcards.window}"
            return [
                self.plan.product(f"{kind}/{name}{suffix}").table
                for settings in self.params.learners(wildcards).values()
                for kind, suffix in _tables_asked(settings)
            ]

        return find

    def element_sets(self, wildcards: Wildcards) -> _Paths:
        """Find the history of an RSO's mean elements; none where no learner asks for SGP4."""
        return self._element_sets(wildcards) if self._is_asked("sgp4", wildcards) else []

    def improved_history(self, wildcards: Wildcards) -> _Paths:
        """Find that history as it could be improved; none where no learner asks for it."""
        if not self._is_asked("improved", wildcards):
            return []
        return self.plan.product(f"improved_history/{wildcards.rso}").table

    def _is_asked(self, kind: str, wildcards: Wildcards) -> bool:
        """Return whether learners ask for a kind of table beside the dataset."""
        asked = map(_tables_asked, self.params.learners(wildcards).values())
        return any(kind in dict(tables) for tables in asked)

    def source(self, wildcards: Wildcards) -> _Paths:
        """Find the tables of what was read of an RSO that may tell its object."""
        rso, plan = wildcards.rso, self.plan
        if rso in plan.settings.files_of(ELEMENTS):
            return [self._element_sets(wildcards)]
        if rso in plan.settings.files_of(FIXES):
            return [plan.product(f"tracking/{rso}/{FIXES.stations}").table]
        if rso in plan.settings.orbits:
            return [plan.product(f"truth/{rso}").table]
        read = {"starts": rso in plan.settings.starts, "tracking": rso in plan.settings.files_of(TRACKS)}
        tables = [table for table, is_read in read.items() if is_read]
        return [plan.product(f"{table}/{rso}/{wildcards.stations}").table for table in tables]

    def _element_sets(self, wildcards: Wildcards) -> str:
        return self.plan.product(f"element_sets/{wildcards.rso}").table

    def long_estimates(self, estimates: _Pattern) -> InputFunction:
        """Find the estimates over the long window; none where no learner reads the mechanism."""

        def find(wildcards: Wildcards) -> _Paths:
            if not self._is_asked("mechanism", wildcards):
                return []
            hours = self.plan.settings.run.mechanism.long_window_hours
            return self._estimates(estimates, wildcards, self.plan.window(hours))

        return find

    def arc_estimates(self, estimates: _Pattern) -> InputFunction:
        """Find the estimates over the windows of the learners' arcs, as `learners.arc_windows` has them."""

        def find(wildcards: Wildcards) -> _Paths:
            windows = learners.arc_windows(self.params.learners(wildcards).values())
            return [self._estimates(estimates, wildcards, self.plan.window(hours)) for hours in windows]

        return find

    def at_arc(self, pattern: _Pattern) -> InputFunction:
        """Find a file of estimates over the window of the wildcard `arc`."""

        def find(wildcards: Wildcards) -> _Paths:
            hours = naming.parse_arc(wildcards.arc)
            return self._estimates(pattern, wildcards, self.plan.window(hours))

        return find

    def _estimates(self, pattern: _Pattern, wildcards: Wildcards, window: str) -> str:
        """Return the path of a file of estimates of the wildcards' RSO and stations."""
        return path_of(pattern, rso=wildcards.rso, stations=wildcards.stations, window=window)

    def model(self, alone: _Pattern, together: _Pattern) -> InputFunction:
        """Find the model of a test.

        alone: trained on its own rows
        together: trained for one test, whose rows standardise its variables too
        """

        def find(wildcards: Wildcards) -> _Paths:
            is_together = wildcards.test.endswith(naming.STANDARDISATIONS["together"])
            return path_of(together if is_together else alone, **dict(wildcards.items()))

        return find

    def futures(self, futures: _Pattern) -> InputFunction:
        """Find the courses that the weather may take; none where predictions fly under no forecast."""

        def find(_: Wildcards) -> _Paths:
            if not self.plan.environment.is_forecast:
                return []
            members = self.plan.settings.run.uncertainty.futures
            return path_of(futures, members=str(members))

        return find
