"""The settings of a run and of the study that asks something of it, checked before anything is computed."""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from glob import glob
from typing import Any

from opml import naming
from opml.base.errors import InputError
from opml.base.files import FilePath, project_file
from opml.base.section import Section
from opml.catalog.kinds import KINDS, Kind, in_place_of_stations, of_fits
from opml.orbits.manoeuvres import read_times
from opml.orbits.sheets import (
    Rso,
    Station,
    parse_stations,
    read_rsos,
    read_stations,
    rsos_from_rows,
    stations_from_rows,
)
from opml.study.settings.model.run import MORNING_MODELS, DaySettings, RangeSettings, Sheets, reading_options
from opml.study.settings.model.whole import RunSettings
from opml.study.settings.overlay import MISSING, Key, Layer, Source, laid_over, read_layer

STUDIES = "config/studies"  # folder of the studies that are called by their names

REAL_SATELLITES = "config/real_satellites.yaml"
"""Settings under those of a user whose orbits come from files or whose tracks were measured."""

_FROM_FILES = ("orbits", *(kind.name for kind in KINDS))

_NAME = re.compile(r"[\w-]+")


@dataclass(frozen=True)
class Settings:
    """All that a run needs: the settings, with the study in full, the stations and the RSOs."""

    values: Mapping[str, Any]
    stations: Mapping[str, Station]
    rsos: Mapping[str, Rso]
    misfit: str = ""  # what the default study asks of days that the run has not; empty where it fits

    @cached_property
    def run(self) -> RunSettings:
        """The same values as typed attributes."""
        return RunSettings.model_validate(self.values)

    @cached_property
    def orbits(self) -> dict[str, list[str]]:
        """Files of the orbits that stand in for a simulated truth, or judge, by RSO."""
        return self._files("orbits")

    def files_of(self, kind: Kind) -> dict[str, list[str]]:
        """Return the files of what was measured in one way, by RSO."""
        return self._files(kind.name)

    def kind_of(self, rso: str) -> Kind | None:
        """Return how an RSO of the sheet was measured; None where its measurements are simulated."""
        return next((kind for kind in KINDS if rso in self.values.get(kind.name, {})), None)

    def options(self, kind: Kind, rso: str) -> Section:
        """Return the options of reading an RSO's files, relative paths in the folder of the data."""
        options = reading_options(kind.options).model_validate(self.values.get(kind.options, {}).get(rso, {}))
        return options.within(self.values.get("data", "")) if isinstance(options, RangeSettings) else options

    def companion_files(self, kind: Kind) -> dict[str, list[str]]:
        """Return the files that are read beside those of a kind, such as of where stations are, by RSO."""
        options = {rso: self.options(kind, rso) for rso in self.values.get(kind.options, {})}
        return {rso: reading.files for rso, reading in options.items() if isinstance(reading, RangeSettings)}

    @property
    def day(self) -> DaySettings:
        """Settings of every morning."""
        return self.run.day or DaySettings()

    @property
    def morning_models(self) -> list[str]:
        """Models that a morning chooses from: those that are named, or what suits the measurements."""
        if self.day.models is not None:
            return self.day.models
        is_fitted = any(map(self.files_of, of_fits()))
        return list(MORNING_MODELS) if is_fitted else []

    def are_radars(self, stations: str) -> bool:
        """Return whether all of a station set are radars; what stands in their place is none."""
        names = naming.strip_seed(stations, naming.NOISE)
        return names not in in_place_of_stations() and all(
            station.is_radar for station in parse_stations(names, self.stations)
        )

    @cached_property
    def measured(self) -> dict[str, list[str]]:
        """Files of all that was really measured, by RSO."""
        return {rso: paths for kind in KINDS for rso, paths in self.files_of(kind).items()}

    def _files(self, kind: str) -> dict[str, list[str]]:
        """Return the user's own files of a kind, by RSO; a pattern without files stays."""
        folder = self.values.get("data", "")
        return {rso: _files(paths, folder) for rso, paths in self.values.get(kind, {}).items()}

    @property
    def starts(self) -> dict[str, str]:
        """File of the state that an RSO's first orbit starts from, by RSO."""
        folder = self.values.get("data", "")
        return {rso: os.path.join(folder, path) for rso, path in self.values.get("starts", {}).items()}

    def manoeuvres(self, rso: str) -> list[str]:
        """Return the UTC texts of an RSO's manoeuvres that the settings name, in a list or a file of one.

        Raises InputError for a file that holds no such list.
        """
        path = self.manoeuvre_files.get(rso)
        return read_times(path) if path else list(self.values.get("manoeuvres", {}).get(rso, []))

    @property
    def manoeuvre_files(self) -> dict[str, str]:
        """File of an RSO's manoeuvres, by RSO, where the settings name one."""
        folder, named = self.values.get("data", ""), self.values.get("manoeuvres", {})
        return {rso: os.path.join(folder, path) for rso, path in named.items() if isinstance(path, str)}

    @property
    def study(self) -> Mapping[str, Any]:
        """The study's settings; empty where there is none."""
        return self.values["study"] or {}


def merged(files: Sequence[FilePath], on_top: Layer | None = None) -> Source:
    """Return settings merged from files, later ones on top, and from a layer above them; the study in full.

    The settings for real satellites lie between the first file and the others, where these name any, and
    above them those for kinds of measurements. Raises InputError for a file that is missing or not YAML.
    """
    first, *rest = [*map(read_layer, files), *([on_top] if on_top else [])]
    layers = [first, *(read_layer(project_file(path)) for path in _beneath(rest) if path), *rest]
    values: Any = {}
    for layer in layers:
        values = laid_over(values, layer.values or values)
    extended, study = _study(values.get("study"), Source(values, layers))
    is_default = not any("study" in layer.values for layer in rest)
    return Source({**values, "study": study}, [*extended, *layers], is_default)


def _beneath(layers: Sequence[Layer]) -> list[str]:
    """Return the files of the settings beneath layers, by what these name files of; '' for none."""
    named = {name for name in _FROM_FILES if any(layer.values.get(name) for layer in layers)}
    return [*([REAL_SATELLITES] if named else []), *(kind.beneath for kind in KINDS if kind.name in named)]


def with_sheets(values: Mapping[str, Any], source: Source | None = None) -> Settings:
    """Return settings with the stations and RSOs of the sheets and of the settings themselves.

    Raises InputError for what is wrong in a sheet; `source` names the file of what the settings hold.
    """
    source = source or Source(values, [])
    sheets = Sheets.model_validate(values.get("sheets"))
    stations, rsos = read_stations(project_file(sheets.stations)), read_rsos(project_file(sheets.rsos))
    own_stations = _inline(source, "stations", stations_from_rows, known=stations)
    from_files = {name for kind in _FROM_FILES for name in values.get(kind, {})}
    own_rsos = _inline(source, "rsos", partial(rsos_from_rows, from_files=from_files), known=rsos)
    return Settings(values, stations | own_stations, rsos | own_rsos)


def _files(paths: str | Sequence[str], folder: str) -> list[str]:
    """Return the files of paths and patterns, relative ones in a folder; a path without a file stays."""
    files: list[str] = []
    for pattern in [paths] if isinstance(paths, str) else paths:
        path = os.path.join(folder, pattern)
        files += sorted(glob(path)) or [path]
    return files


def _inline(source: Source, kind: str, parse: Any, *, known: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a sheet's rows hold that stand in the settings."""
    parsed: dict[str, Any] = {}
    for name, row in source.values.get(kind, {}).items():
        if name in known:
            raise source.wrong((kind, name), f"expected a name that {source.values['sheets'][kind]} has not")
        try:
            parsed |= parse({name: row})
        except InputError as error:
            column, _, what = str(error).partition(": ")
            if column in row:  # the columns of a row may stand in several files
                raise source.wrong((kind, name, column), what) from None
            raise source.wrong((kind, name), str(error)) from None
    return parsed


def _study(
    study: Any, source: Source, key: Key = ("study",), above: tuple[str, ...] = ()
) -> tuple[list[Layer], Any]:
    """Return the layers that a study extends, and the study in full: None where there is none."""
    if study is None or study == {}:
        return [], None
    names, on_top = (study.get("extends", []), study) if isinstance(study, Mapping) else (study, {})
    layers: list[Layer] = []
    whole: Any = MISSING
    for name in [names] if isinstance(names, str) else names if isinstance(names, list) else [names]:
        layer = _study_file(name, source, key, above)
        below, extended = _study(
            layer.values["study"], Source(layer.values, [layer]), key, (*above, layer.name)
        )
        layers += [*below, layer]
        whole = laid_over(whole, extended)
    parts = {part: value for part, value in on_top.items() if part != "extends"}
    return layers, laid_over(whole, parts) if parts else whole


def _study_file(name: Any, source: Source, key: Key, above: Sequence[str]) -> Layer:
    """Read a study by its name or path. Raises InputError for what is none or extends itself."""
    if not isinstance(name, str) or not name:
        raise source.wrong(key, f"expected a study, or names of studies, got {name!r}")
    layer = read_layer(project_file(f"{STUDIES}/{name}.yaml") if _NAME.fullmatch(name) else name)
    if layer.name in above:
        raise source.wrong(key, f"expected studies that do not extend themselves, got {layer.name}")
    for part in layer.values:
        if part != "study":
            message = (
                f"expected nothing but a study here, as it is extended; a run is --configfile={layer.name}"
            )
            raise InputError(f"{layer.name}: {part}: {message}")
    if not isinstance(layer.values.get("study"), Mapping | list | str):
        raise InputError(f"{layer.name}: study: expected a mapping, got none")
    return layer
