"""Checks that no schema can say: settings together, the sheets, the files and the study's parts."""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from opml import naming
from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import PACKAGED
from opml.catalog import kinds
from opml.catalog.kinds import KINDS, Kind
from opml.environment import known_weather
from opml.interop import first_state, orbit_from_files
from opml.learning.data.dataset import MEASUREMENT
from opml.learning.data.error_components import CORRECTED
from opml.learning.models import learners
from opml.orbits import sheets
from opml.study import source_coverage
from opml.study.experiments import Study
from opml.study.settings.merging import Settings, with_sheets
from opml.study.settings.overlay import MISSING, Key, Source, mappings, value_at
from opml.study.settings.validation import validated


def load_settings(source: Source) -> Settings:
    """Check merged settings and read the sheets that they name.

    Raises InputError: one line with file and key, for the first thing that is wrong.
    """
    for key in mappings(source.values):
        for name in value_at(source.values, key):
            if not isinstance(name, str):
                raise source.wrong((*key, name), "expected a key that is text")
    run = validated(source)
    _check_order(source)
    results = Path(source.values["results"])
    for path in (results, *results.parents):
        if path.is_file():
            raise source.wrong(("results",), f"expected a folder, got a file at {path}")
    for kind, path in source.values["sheets"].items():
        # The package's own settings alone name the package's own sheets.
        if source.origin(("sheets", kind)) != str(PACKAGED) and not Path(path).exists():
            raise source.wrong(("sheets", kind), f"{path}: no such file")
    settings = with_sheets(source.values, source)
    misfit = _misfit(source, settings)
    learners.check(run.learners, variables=run.learning.variables, resonances=run.mechanism.resonances)
    _check_day(source, settings)
    return replace(settings, misfit=misfit)


def check_data(source: Source, settings: Settings) -> None:
    """Look at the data that a run needs: how far they reach, and whether a user's own files fit the run.

    Takes seconds where there are many files of orbits. Raises InputError for the first thing that is wrong.
    """
    _check_paths(source, settings)
    source_coverage.check(settings.run, is_measured=bool(settings.measured))
    run = settings.run
    for name, paths in settings.orbits.items():
        with source.naming(("orbits", name)):
            sheets.parse_rso(name, settings.rsos)
            duration = DAY * run.duration_days
            orbit_from_files.read_arcs(orbit_from_files.OrbitFiles(paths, run.epoch, duration))
    if settings.run.day is None:  # every morning looks at the files itself, and leaves out bad ones
        for kind in KINDS:
            _check_measured(source, settings, kind)
    _check_starts(source, settings)


def check_study(source: Source, settings: Settings, *, last_day: float | None = None) -> None:
    """Hold the parts of the study against the sheets, the learners, the days of the run and each other.

    last_day: up to which the study may ask for days; None for the run's own. Raises InputError.
    """
    checks = _Checks(settings, settings.run.duration_days if last_day is None else last_day).by_kind
    for key, kind, value in _parts(settings.study):
        with source.naming(("study", *key)):
            checks.get(kind, bool)(value)
    for name, entry in _mapping(settings.study, ("evaluations",)).items():
        experiment = Study(settings).experiment(entry)
        if experiment.test == "seen" and experiment.target != experiment.rso:
            key = ("study", "evaluations", name, "test")
            raise source.wrong(key, "expected another split, as seen rows are the RSO's own")
    _check_references(source, settings)
    study = Study(settings)
    _check_kinds(source, study)
    for rso in study.rsos:
        if study.label == "truth" and not study.has_truth(rso):
            message = f"expected later, as {rso} was measured and has no truth, got truth"
            raise source.wrong(("study", "label"), message)
    _check_stations(source, study)
    _check_variables(source, study)


def _check_day(source: Source, settings: Settings) -> None:
    """Raise InputError for a model of the mornings that learns, or asks for more than fits of one RSO."""
    run = settings.run
    if run.day is None:
        if settings.files_of(kinds.ELEMENTS):
            raise source.wrong(("elements",), "expected `day`, as mornings alone read element sets, got none")
        return
    if run.estimation.suspect_sigma is not None:
        raise source.wrong(("estimation", "suspect_sigma"), "expected none with mornings (day)")
    for kind in KINDS:
        if settings.files_of(kind) and not kind.for_mornings:
            raise source.wrong((kind.name,), "expected none with mornings (day), as these read none")
    for name in run.day.messages or ():
        if name not in settings.measured:
            raise source.wrong(("day", "messages"), f"expected objects that were measured, got {name}")
    _check_places(run.day.passes, source)
    for name in settings.morning_models:
        with source.naming(("day", "models")):
            chosen = naming.parse_learner(name, Study(settings).learners)
            learner = chosen.resolved(component=CORRECTED, variables=run.learning.variables)
            fits = {"arcs", "cd_past"}
            if learners.learns(learner.own) or not fits.issuperset(learners.needed_tables(learner.variables)):
                raise InputError(f"expected a model that learns nothing, made of fits of one RSO, got {name}")


def _check_places(places: Sequence[str], source: Source) -> None:
    """Raise InputError for a place of passes that is none."""
    for text in places:
        from opml.element_sets import station_passes  # kernels, which most plans do not await

        try:
            station_passes.place(text)
        except InputError as reason:
            raise source.wrong(("day", "passes"), str(reason).partition(": ")[2]) from None


def _misfit(source: Source, settings: Settings) -> str:
    """Return what the default study asks of days that the run has not; empty where it fits.

    Raises InputError for anything else that is wrong with it, and for any other study that is wrong.
    """
    try:
        check_study(source, settings)
    except InputError as error:
        if not source.has_default_study:
            raise
        check_study(source, settings, last_day=math.inf)
        return f'{error}; "study: {{}}" in a file, or --config study={{}}, asks for no study'
    return ""


def _check_order(source: Source) -> None:
    """Hold settings against each other that only make sense together, or in one order."""
    for lower, upper in (
        (("integrator", "min_step_s"), ("integrator", "max_step_s")),
        (("study", "cleaning", "cd_min"), ("study", "cleaning", "cd_max")),
        (("force_models", "truth", "order"), ("force_models", "truth", "degree")),
        (("force_models", "assumed", "order"), ("force_models", "assumed", "degree")),
    ):
        low, high = _both(source, lower, upper)
        if low is not MISSING and low > high:
            raise source.wrong(lower, f"expected at most {upper[-1]}, got {low} and {high}")
    sources = source.values["environment"]
    if sources.get("knowledge") == known_weather.FORECAST and "issue_hours" not in sources:
        raise source.wrong(("environment", "issue_hours"), "expected a value, got none")
    _both(source, ("study", "cleaning", "fence"), ("study", "cleaning", "fence_days"))
    for key in (("cleaning", "fence_days"), ("span_days",), ("days", "train"), ("days", "test")):
        days = value_at(source.values, ("study", *key))
        if days is not MISSING and days[0] >= days[1]:
            message = f"expected the first day before the last, got {days[0]} and {days[1]}"
            raise source.wrong(("study", *key), message)
    _check_days(source)


def _check_days(source: Source) -> None:
    """Days to test on follow those to train on; a study asks for days or for splits."""
    study = source.values["study"]
    if not isinstance(study, Mapping) or "days" not in study:
        return
    if "splits" in study:
        raise source.wrong(("study", "days"), "expected days, or splits by their names, got both")
    train, test = study["days"]["train"], study["days"]["test"]
    if test[0] < train[1]:
        expected = f"expected days that follow those to train on, from {train[1]:g}"
        raise source.wrong(("study", "days", "test"), f"{expected}, got {test[0]:g} to {test[1]:g}")


def _both(source: Source, first: Key, second: Key) -> tuple[Any, Any]:
    """Return two values of which neither makes sense alone; MISSING where there are none."""
    values = value_at(source.values, first), value_at(source.values, second)
    if (values[0] is MISSING) != (values[1] is MISSING):
        missing, present = (first, second) if values[0] is MISSING else (second, first)
        raise source.wrong(missing, f"expected a value with {present[-1]}, got none")
    return values


def _check_paths(source: Source, settings: Settings) -> None:
    """Raise InputError for a user's file with braces in its path: Snakemake has no escape for them."""
    kinds: Mapping[str, Mapping[str, Any]] = {
        "orbits": settings.orbits,
        **{kind.name: settings.files_of(kind) for kind in KINDS},
        **{kind.options: settings.companion_files(kind) for kind in KINDS},
        "starts": settings.starts,
        "manoeuvres": settings.manoeuvre_files,
        "environment": source.values["environment"],
    }
    for kind, entries in kinds.items():
        for name, paths in entries.items():
            for path in paths if isinstance(paths, list) else [str(paths)]:
                if re.search("[{}]", path):
                    raise source.wrong((kind, name), f"expected a path without braces, got {path}")


def _check_measured(source: Source, settings: Settings, kind: Kind) -> None:
    """Look at what was measured in one way: its RSOs, each measured in no other, and whether files fit."""
    values, files = source.values, settings.files_of(kind)
    if strange := [name for name in values.get(kind.options, {}) if name not in files]:
        raise source.wrong((kind.options, strange[0]), f"expected an RSO that has {kind.name}")
    for name, paths in files.items():
        if kind.needs_options and name not in values.get(kind.options, {}):
            raise source.wrong((kind.name, name), f"expected {name} under {kind.options}, too, got none")
        with source.naming((kind.name, name)):
            rso = sheets.parse_rso(name, settings.rsos)
            if others := [other for other in KINDS if other is not kind and name in settings.files_of(other)]:
                raise InputError(f"expected one of {kinds.names()}, got {kind.name} and {others[0].name}")
            # With compiled kernels: half a second that no plan without such files waits for.
            from opml.catalog import measured_files

            span = measured_files.Span(settings.run.epoch, DAY * settings.run.duration_days)
            source_files = measured_files.MeasurementSource(
                kind=kind.name, files=paths, options=settings.options(kind, name)
            )
            measured_files.check(source_files, span, settings.stations)
        if not kind.tells_orbit and name not in settings.starts and not math.isfinite(rso.a):
            expected = f"expected elements, or a file under starts, as {kind.name} alone give no first orbit"
            raise source.wrong(("rsos", name), f"{expected}, got neither")


def _check_starts(source: Source, settings: Settings) -> None:
    """Look at first states and times of manoeuvres, which stand beside tracks that were measured."""
    for kind in ("starts", "manoeuvres"):
        for name in source.values.get(kind, {}):
            with source.naming((kind, name)):
                if settings.kind_of(name) not in kinds.of_fits():
                    raise InputError(f"expected an RSO that has {kinds.names(kinds.of_fits())}")
                if kind == "starts":
                    first_state.identity(settings.starts[name])
                else:
                    for time in settings.manoeuvres(name):
                        epochs.parse(time)


def _check_kinds(source: Source, study: Study) -> None:
    """Raise InputError for a study of an RSO that element sets alone tell of."""
    for rso in study.settings.study.get("rsos", ()):
        if study.kind_of(rso) is kinds.ELEMENTS:
            instead = "`opml predict` predicts from them, `opml day --since` replays past mornings"
            raise source.wrong(("study", "rsos"), f"expected RSOs without elements, got {rso}: {instead}")


def _check_stations(source: Source, study: Study) -> None:
    """Raise InputError where stations stand beside RSOs that others measured, or fixes beside others."""
    for rso in study.rsos:
        for stations in study.station_sets:
            known_by = study.in_place_of_stations(rso)
            if known_by != (stations if stations in kinds.in_place_of_stations() else ""):
                expected = f"RSOs that all have {known_by}" if known_by else f"an RSO that has {stations}"
                key = ("study", "rsos") if "rsos" in study else ("study", "station_sets")
                raise source.wrong(key, f"expected {expected} for {stations}, got {rso} among them")


def _check_variables(source: Source, study: Study) -> None:
    """Raise InputError where a learner asks for what radars measure, and the study has others or fixes."""
    others = [stations for stations in study.station_sets if not study.settings.are_radars(stations)]
    if not others:
        return
    for name, settings in study.learners.items():
        if measured := [variable for variable in settings.get("variables") or () if variable in MEASUREMENT]:
            expected = f"expected variables that {others[0]} have, too"
            raise source.wrong(("learners", name, "variables"), f"{expected}, got {measured[0]}")


def _check_references(source: Source, settings: Settings) -> None:
    study = settings.study
    for key, known in (
        (("individual",), study.get("evaluations", {})),
        (("partition", "shown"), study.get("partition", {}).get("ratios", [])),
        (("reproduction", "calibrated"), study.get("evaluations", {})),
        (("reproduction", "fixed"), settings.run.learners),
    ):
        named = value_at(study, key)
        for name in [] if named is MISSING else named if isinstance(named, list) else [named]:
            if name not in known:
                expected = f"one of {', '.join(map(str, known))}"
                raise source.wrong(("study", *key), f"expected {expected}, got {name!r}")
    fixed = study.get("reproduction", {}).get("fixed")
    if fixed and not isinstance(settings.run.learners[fixed].get("kernel_scale"), float):
        raise source.wrong(("learners", fixed, "kernel_scale"), "expected a number, as it is one fixed scale")


_ENTRIES = (*((), ("defaults",), ("orbit",), ("partition",)),)
_MAPPINGS_OF_ENTRIES = (("evaluations",), ("grids",), ("curves",), ("reproduction", "readings"))


def _parts(study: Mapping[str, Any]) -> Iterator[tuple[Key, str, Any]]:
    """Yield key, kind and value of everything that names stations, RSOs, learners, splits or days."""
    keys: list[Key] = list(_ENTRIES)
    for group in _MAPPINGS_OF_ENTRIES:
        keys += [(*group, name) for name in _mapping(study, group)]
    for key in keys:
        entry = _mapping(study, key)
        for part, value in entry.items():
            varies = part == "values"
            kind = str(key[-1]) if varies else part
            yield (*key, part), kind, (entry.get("rso"), value) if varies else value


def _mapping(values: Mapping[str, Any], key: Key) -> Mapping[str, Any]:
    mapping = value_at(values, key)
    return {} if mapping is MISSING else mapping


class _Checks:
    """Checks of each kind of part against what there is; raise InputError for what is not."""

    def __init__(self, settings: Settings, duration: float) -> None:
        self._settings = settings
        self._duration = duration
        self.by_kind: Mapping[str, Callable[[Any], object]] = {
            "rso": self._rso,
            "target": self._rso,
            "rsos": _each(self._rso),
            "inclination": lambda pair: self._varied(sheets.name_at_inclination, *pair),
            "semi_major_axis": lambda pair: self._varied(sheets.name_at_offset, *pair),
            "stations": self._stations,
            "distribution": self._stations,
            "station_sets": _each(self._stations),
            "learner": self._learner,
            "learners": _each(self._learner),
            "train": self._train,
            "test": self._test,
            "tests": _each(self._test),
            "split": self._pair,
            "splits": lambda pairs: _each(self._pair)(
                list(pairs.values()) if isinstance(pairs, Mapping) else pairs
            ),
            "window_day": lambda day: self._days([0, day]),
            "zoom_days": self._days,
            "span_days": self._days,
            "days": lambda days: _each(self._days)(
                list(days.values()) if isinstance(days, Mapping) else [days]
            ),
        }

    def _rso(self, text: str) -> None:
        sheets.parse_rso(text, self._settings.rsos)

    def _varied(self, name: Callable[..., str], rso: str | None, values: Sequence[float]) -> None:
        rso = rso or Study(self._settings).defaults["rso"]
        for value in values:
            self._rso(name(rso, value, self._settings.rsos))

    def _stations(self, text: str) -> None:
        if text not in kinds.in_place_of_stations():
            sheets.parse_stations(text, self._settings.stations)

    def _learner(self, text: str) -> None:
        naming.parse_learner(text, self._settings.run.learners)

    def _train(self, text: str) -> None:
        naming.check_split(naming.parse_train(text), duration_days=self._duration)

    def _test(self, text: str) -> None:
        naming.check_split(naming.parse_test(text), duration_days=self._duration)

    def _pair(self, pair: Sequence[str] | str) -> None:
        # A reading's `split` is a word, not a pair.
        if not isinstance(pair, str):
            self._train(pair[0])
            self._test(pair[1])

    def _days(self, days: Sequence[float]) -> None:
        first, last = days
        if not first < last <= self._duration:
            raise InputError(
                f"expected ascending days up to duration_days, {self._duration:g}, got {first:g} and {last:g}"
            )


def _each(check: Callable[[Any], None]) -> Callable[[Sequence[Any]], None]:
    def check_each(values: Sequence[Any]) -> None:
        for value in values:
            check(value)

    return check_each
