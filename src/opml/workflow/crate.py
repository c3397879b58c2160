"""A finished run as one archive that tells its making: RO-Crate, profile Workflow Run Crate 0.5.

    opml pack --configfile mine.yaml [--config KEY=VALUE ...]

Source: https://w3id.org/ro/wfrun/workflow/0.5, by the library rocrate (the extra `crate`).
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from importlib import resources
from importlib.metadata import distributions, version
from mimetypes import guess_type
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import yaml
from rocrate.model.contextentity import ContextEntity
from rocrate.rocrate import ROCrate

from opml import __version__
from opml.base.errors import InputError
from opml.base.files import PROJECT, FilePath, project_file, replacing
from opml.study.settings.merging import merged, with_sheets
from opml.study.settings.overlay import COMMAND_LINE, Layer

DISTRIBUTION = "opml-orbits"
_PAPER = "https://doi.org/10.1016/j.asr.2018.03.001"
_LICENSE = "https://spdx.org/licenses/MIT"
_BIOSCHEMAS = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": "Workflow RO-Crate",
}


_PROGRAM = {"@type": "SoftwareApplication"}
_KINDS = {".parquet": "application/vnd.apache.parquet", ".md": "text/markdown", ".yaml": "application/yaml"}


def pack(configfiles: Sequence[FilePath], config: Mapping[str, Any] | None = None) -> Path:
    """Write a finished run into an archive beside its results; returns the archive's path.

    `configfiles` and `config` are what the run was given; it is that of the present folder. Raises InputError
    where there are no results, or a file of one's own is missing.
    """
    files = ["config/config.yaml", *configfiles]
    values = merged(files, Layer(COMMAND_LINE, config or {})).values
    results = Path(values["results"])
    products = list(_files(results))
    if not products:
        raise InputError(f"{results}: expected the results of a run, got none")
    archive = results.with_name(f"{results.name}.crate.zip")
    with TemporaryDirectory() as folder:
        settings = Path(folder) / "settings.yaml"
        settings.write_text(yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
        crate = _described(results, products)
        workflow = _workflow(crate)
        asked = [_file(crate, settings, "settings.yaml", _setting(crate, workflow))]
        asked += [_file(crate, path, _place(path)) for path in _inputs(files, values)]
        _add_run(crate, workflow, asked, [_file(crate, path, _inside(path, results)) for path in products])
        with replacing(archive) as temporary:
            crate.write_zip(temporary)
    return archive


def settings_of(pairs: Sequence[str]) -> dict[str, Any]:
    """Return settings that a command line gave as KEY=VALUE."""
    return {key: yaml.safe_load(value) for key, _, value in (pair.partition("=") for pair in pairs)}


def _described(results: Path, products: Sequence[Path]) -> Any:
    """An empty crate that tells what it holds, by which profiles."""
    crate = ROCrate(version="1.1")
    crate.name = f"Run of opml: {results.name}"
    crate.description = "Orbit predictions and their corrections. Each table tells its units and its making."
    crate.license = crate.add(ContextEntity(crate, _LICENSE, {"@type": "CreativeWork", "name": "MIT"}))
    crate.datePublished = _time(products, max)
    crate.root_dataset["conformsTo"] = [
        crate.add(ContextEntity(crate, at, {"@type": "CreativeWork", "name": name, "version": Path(at).name}))
        for at, name in _PROFILES.items()
    ]
    return crate


def _workflow(crate: Any) -> Any:
    """Add the workflow's files and what it needs; returns the entity of its Snakefile."""
    folder = Path("workflow") if Path("workflow/Snakefile").is_file() else PROJECT / "workflow"
    about = {"name": "opml", "version": __version__, "encodingFormat": "text/plain"}
    linked = {"license": _LICENSE, "citation": _PAPER, "conformsTo": _BIOSCHEMAS}
    workflow = crate.add_workflow(
        folder / "Snakefile",
        "workflow/Snakefile",
        main=True,
        lang="snakemake",
        lang_version=version("snakemake"),
        properties=about | {name: {"@id": at} for name, at in linked.items()},
    )
    for path in _files(folder):
        if path.name != "Snakefile":
            _file(crate, path, f"workflow/{_inside(path, folder)}")
    sources = Path(str(resources.files("opml") / "data" / "README.md"))
    _file(crate, sources, "sources.md", {"name": "Sources of the packaged data"})
    workflow["softwareRequirements"] = _packages(crate)
    return workflow


def _setting(crate: Any, workflow: Any) -> dict[str, Any]:
    """Properties of the settings in full: they are what the workflow takes as its parameter."""
    parameter = crate.add_formal_parameter("settings", "File", identifier="#settings")
    workflow["input"] = parameter
    return {"name": "All settings of the run", "exampleOfWork": {"@id": parameter.id}}


def _add_run(crate: Any, workflow: Any, asked: list[Any], made: list[Any]) -> None:
    """Add the run itself: what made which files of what, and when."""
    times = [Path(entity.source) for entity in made]
    told = "What the settings ask for, made by Snakemake; times of the first and the last file"
    about = {"name": "Run of the workflow", "description": told}
    about |= {"startTime": _time(times, min), "endTime": _time(times, max)}
    run = crate.add_action(workflow, identifier="#run", object=asked, result=made, properties=about)
    crate.root_dataset["mentions"] = run


def _packages(crate: Any) -> list[Any]:
    """The package, and all that is installed beside it."""
    found = {one.name: one.version for one in distributions()} | {DISTRIBUTION: __version__}
    return [
        crate.add(
            ContextEntity(crate, f"pkg:pypi/{name}@{number}", _PROGRAM | {"name": name, "version": number})
        )
        for name, number in sorted(found.items())
    ]


def _inputs(files: Sequence[FilePath], values: Any) -> Iterator[Path]:
    """The run's own files: settings, sheets, orbits, tracks and first states."""
    settings = with_sheets(values)
    named = [*files, *values["sheets"].values(), *settings.starts.values()]
    named += [path for paths in (*settings.orbits.values(), *settings.tracks.values()) for path in paths]
    named += [name for name in values["environment"].values() if Path(str(name)).suffix]
    for path in map(project_file, dict.fromkeys(named)):
        if not path.is_file():
            raise InputError(f"{path}: expected a file that the run was made of, got none")
        yield path


def _place(path: Path) -> str:
    """Where a file of one's own stands in the archive: as in the project, or below its last folder."""
    whole, project = path.absolute(), Path.cwd()
    inside = whole.relative_to(project) if whole.is_relative_to(project) else Path(*whole.parts[-2:])
    return f"inputs/{inside.as_posix()}"


def _files(folder: Path) -> Iterator[Path]:
    """All files below a folder in the order of their names, less hidden and compiled ones."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not any(part.startswith((".", "__")) for part in path.parts):
            yield path


def _file(crate: Any, path: Path, to: str, about: dict[str, Any] | None = None) -> Any:
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    kind = _KINDS.get(path.suffix) or guess_type(path.name)[0] or "application/octet-stream"
    properties = {"sha256": digest, "encodingFormat": kind, **(about or {})}
    return crate.add_file(path, to, record_size=True, properties=properties)


def _inside(path: Path, folder: Path) -> str:
    return path.relative_to(folder).as_posix()


def _time(paths: Sequence[Path], which: Any) -> str:
    """First or last time at which files were written, in UTC."""
    return datetime.fromtimestamp(which(path.stat().st_mtime for path in paths), UTC).isoformat(
        "T", "seconds"
    )
