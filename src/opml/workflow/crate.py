"""A finished run as one archive that tells how it was made: RO-Crate, profile Workflow Run Crate 0.5.

    opml pack --configfile mine.yaml [--config KEY=VALUE ...]

Source: https://w3id.org/ro/wfrun/workflow/0.5, by the library rocrate (the extra `crate`).
"""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
from opml.study.settings.validation import validated

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
    """Write a finished run of this folder into an archive beside its results; return the archive's path.

    Raises InputError where the run has no results, or a file that it was made of is missing.

    configfiles: the files behind the run's --configfile
    config: settings behind the run's --config
    """
    files = ["config/config.yaml", *configfiles]
    source = merged(files, Layer(COMMAND_LINE, config or {}))
    values, results = source.values, Path(validated(source).results)
    products = list(_files(results))
    if not products:
        raise InputError(f"{results}: expected the results of a run, got none")
    archive = results.with_name(f"{results.name}.crate.zip")
    with TemporaryDirectory() as folder:
        settings = Path(folder) / "settings.yaml"
        settings.write_text(yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
        crate = _new_crate(results, products)
        workflow = _add_workflow(crate)
        inputs = [_add_file(crate, settings, "settings.yaml", _setting(crate, workflow))]
        inputs += [_add_file(crate, path, _place(path)) for path in _inputs(files, values)]
        outputs = [_add_file(crate, path, _relative(path, results)) for path in products]
        _add_run(crate, workflow, inputs, outputs)
        with replacing(archive) as temporary:
            crate.write_zip(temporary)
    return archive


def settings_of(pairs: Sequence[str]) -> dict[str, Any]:
    """Return settings that a command line gave as KEY=VALUE."""
    return {key: yaml.safe_load(value) for key, _, value in (pair.partition("=") for pair in pairs)}


def _new_crate(results: Path, products: Sequence[Path]) -> Any:
    """Return a crate without files that tells what it is to hold, and its profiles."""
    crate = ROCrate(version="1.1")
    crate.name = f"Run of opml: {results.name}"
    crate.description = "Orbit predictions and their corrections. Each table has its units and its origin."
    crate.license = crate.add(ContextEntity(crate, _LICENSE, {"@type": "CreativeWork", "name": "MIT"}))
    crate.datePublished = _time(products, max)
    crate.root_dataset["conformsTo"] = [
        crate.add(
            ContextEntity(crate, url, {"@type": "CreativeWork", "name": name, "version": Path(url).name})
        )
        for url, name in _PROFILES.items()
    ]
    return crate


def _add_workflow(crate: Any) -> Any:
    """Add the workflow's files and the packages it needs; return the entity of its Snakefile."""
    folder = Path("workflow") if Path("workflow/Snakefile").is_file() else PROJECT / "workflow"
    about = {"name": "opml", "version": __version__, "encodingFormat": "text/plain"}
    linked = {"license": _LICENSE, "citation": _PAPER, "conformsTo": _BIOSCHEMAS}
    workflow = crate.add_workflow(
        folder / "Snakefile",
        "workflow/Snakefile",
        main=True,
        lang="snakemake",
        lang_version=version("snakemake"),
        properties=about | {name: {"@id": url} for name, url in linked.items()},
    )
    for path in _files(folder):
        if path.name != "Snakefile":
            _add_file(crate, path, f"workflow/{_relative(path, folder)}")
    sources = Path(str(resources.files("opml") / "data" / "README.md"))
    _add_file(crate, sources, "sources.md", {"name": "Sources of the packaged data"})
    workflow["softwareRequirements"] = _add_packages(crate)
    return workflow


def _setting(crate: Any, workflow: Any) -> dict[str, Any]:
    """Return the properties of the settings in full, the workflow's one parameter."""
    parameter = crate.add_formal_parameter("settings", "File", identifier="#settings")
    workflow["input"] = parameter
    return {"name": "All settings of the run", "exampleOfWork": {"@id": parameter.id}}


def _add_run(crate: Any, workflow: Any, inputs: list[Any], outputs: list[Any]) -> None:
    """Add the run itself, from the entities of its files, with the times of the first and the last output."""
    paths = [Path(entity.source) for entity in outputs]
    description = "What the settings ask for, made by Snakemake; times of the first and the last file"
    about = {"name": "Run of the workflow", "description": description}
    about |= {"startTime": _time(paths, min), "endTime": _time(paths, max)}
    run = crate.add_action(workflow, identifier="#run", object=inputs, result=outputs, properties=about)
    crate.root_dataset["mentions"] = run


def _add_packages(crate: Any) -> list[Any]:
    installed = {distribution.name: distribution.version for distribution in distributions()}
    return [
        crate.add(
            ContextEntity(crate, f"pkg:pypi/{name}@{number}", _PROGRAM | {"name": name, "version": number})
        )
        for name, number in sorted((installed | {DISTRIBUTION: __version__}).items())
    ]


def _inputs(files: Sequence[FilePath], values: Any) -> Iterator[Path]:
    """Yield the files that the run was made of: settings, sheets, orbits, and all that was measured."""
    settings = with_sheets(values)
    named = [
        *files,
        settings.run.sheets.stations,
        settings.run.sheets.rsos,
        *settings.starts.values(),
        *settings.manoeuvre_files.values(),
    ]
    named += [path for paths in (*settings.orbits.values(), *settings.measured.values()) for path in paths]
    sources = settings.run.environment.model_dump().values()
    named += [str(name) for name in sources if Path(str(name)).suffix]
    for path in map(project_file, dict.fromkeys(named)):
        if not path.is_file():
            raise InputError(f"{path}: expected a file that the run was made of, got none")
        yield path


def _place(path: Path) -> str:
    """Return where an input stands in the archive: as in the project, else below the name of its folder."""
    whole, project = path.absolute(), Path.cwd()
    inside = whole.relative_to(project) if whole.is_relative_to(project) else Path(*whole.parts[-2:])
    return f"inputs/{inside.as_posix()}"


def _files(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not any(part.startswith((".", "__")) for part in path.parts):
            yield path


def _add_file(crate: Any, path: Path, place: str, about: dict[str, Any] | None = None) -> Any:
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    kind = _KINDS.get(path.suffix) or guess_type(path.name)[0] or "application/octet-stream"
    properties = {"sha256": digest, "encodingFormat": kind, **(about or {})}
    return crate.add_file(path, place, record_size=True, properties=properties)


def _relative(path: Path, folder: Path) -> str:
    return path.relative_to(folder).as_posix()


def _time(paths: Sequence[Path], extreme: Callable[[Iterable[float]], float]) -> str:
    seconds = extreme(path.stat().st_mtime for path in paths)
    return datetime.fromtimestamp(seconds, UTC).isoformat("T", "seconds")
