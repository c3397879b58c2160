"""Input functions: the files that a job reads, by the wildcards of what it makes.

Functions and methods that find something return such an input function. They take patterns, which are the
outputs of other rules.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Concatenate, ParamSpec, Protocol

from opml import naming
from opml.base.errors import InputError
from opml.catalog.kinds import FIXES, TRACKS
from opml.learning.models import learners
from opml.learning.models.contract import ResolvedSettings
from opml.naming import Experiment
from opml.workflow.params import Params, Wildcards
from opml.workflow.plan import Plan, end_plan

_Paths = str | list[str]
InputFunction = Callable[[Wildcards], _Paths]
Arguments = ParamSpec("Arguments")


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


def _tables_needed(settings: ResolvedSettings) -> list[tuple[str, str]]:
    """Return kind and suffix of the further tables that have the variables of a learner."""
    suffixes: dict[str, str] = {}
    if arc := learners.arc_of(settings):
        suffixes["arcs"] = naming.number_suffix(naming.ARC, arc[0])
        suffixes["cd_past"] = suffixes["arcs"] + naming.number_suffix(naming.MEMORY, arc[1])
    return [(kind, suffixes.get(kind, "")) for kind in learners.needed_tables(settings.variables)]


def _input_function(
    find: Callable[Concatenate["Inputs", Wildcards, Arguments], _Paths],
) -> Callable[Concatenate["Inputs", Arguments], InputFunction]:
    """Return the method of patterns alone that returns the input function of a method of wildcards, too."""

    @wraps(find)
    def of_patterns(self: "Inputs", /, *args: Arguments.args, **kwargs: Arguments.kwargs) -> InputFunction:
        return lambda wildcards: find(self, wildcards, *args, **kwargs)

    return of_patterns


@dataclass(frozen=True)
class Inputs:
    """Input functions that depend on the settings of a run."""

    plan: Plan
    params: Params

    def activity(self, wildcards: Wildcards) -> str:
        """Return the path of the solar activity of an RSO's truth, or of the assumed one if unknown."""
        environment = self.plan.environment
        tables = (
            environment.predictions if wildcards.rso in self.plan.settings.measured else environment.truth
        )
        return tables["solar_activity"]

    @_input_function
    def truth(self, wildcards: Wildcards, truth: _Pattern) -> _Paths:
        """Find the truth of an RSO; none where it was measured and no orbit judges."""
        has_truth = (
            wildcards.rso not in self.plan.settings.measured or wildcards.rso in self.plan.settings.orbits
        )
        return path_of(truth, rso=wildcards.rso) if has_truth else []

    @_input_function
    def truth_or(self, wildcards: Wildcards, truth: _Pattern, measured: _Pattern) -> _Paths:
        """Find the truth of an RSO, or a table in its place where it was measured.

        measured: the table in its place, of an RSO and stations
        """
        if wildcards.rso in self.plan.settings.measured:
            return path_of(measured, rso=wildcards.rso, stations=wildcards.stations)
        return path_of(truth, rso=wildcards.rso)

    @_input_function
    def later_estimates(self, wildcards: Wildcards, estimates: _Pattern) -> _Paths:
        """Find the later estimates that labels are made of; none where the truth is known."""
        return at_window("", estimates)(wildcards) if wildcards.label else []

    @_input_function
    def true_errors(self, wildcards: Wildcards, dataset: _Pattern) -> _Paths:
        """Find the dataset with the true errors behind labels; none without labels or without a truth.

        It is of the RSO under test, where the name has one.
        """
        parts = dict(wildcards.items())
        rso = parts.get("target", wildcards.rso)
        if not wildcards.label or not self.plan.study.has_truth(rso):
            return []
        return path_of(dataset, **parts | {"rso": rso})

    @_input_function
    def learner_tables(self, wildcards: Wildcards, part: str) -> _Paths:
        """Find the further tables that have the variables of a learner.

        part: wildcard of the RSO, `rso` or `target`
        """
        rso = dict(wildcards.items())[part]
        name = f"{rso}/{wildcards.stations}{wildcards.window}"
        return [
            self.plan.product(f"{kind}/{name}{suffix}").table
            for kind, suffix in _tables_needed(self.params.resolved(wildcards))
        ]

    def source(self, wildcards: Wildcards) -> _Paths:
        """Find the tables of what was read of an RSO that may tell its object."""
        rso, plan = wildcards.rso, self.plan
        if rso in plan.settings.files_of(FIXES):
            return [plan.product(f"tracking/{rso}/{FIXES.stations}").table]
        if rso in plan.settings.orbits:
            return [plan.product(f"truth/{rso}").table]
        read = {"starts": rso in plan.settings.starts, "tracking": rso in plan.settings.files_of(TRACKS)}
        tables = [table for table, is_read in read.items() if is_read]
        return [plan.product(f"{table}/{rso}/{wildcards.stations}").table for table in tables]

    @_input_function
    def at_arc(self, wildcards: Wildcards, pattern: _Pattern) -> _Paths:
        """Find a file of estimates over the window of the wildcard `arc`."""
        return at_window(self.plan.window(naming.parse_number(wildcards.arc)), pattern)(wildcards)
