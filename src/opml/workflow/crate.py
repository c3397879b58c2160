"""A finished run as one archive that describes how it was made: RO-Crate, profile Workflow Run Crate 0.5.

    python -m opml.workflow.crate --configfile mine.yaml [--config KEY=VALUE ...]

Source: https://w3id.org/ro/wfrun/workflow/0.5, by the library rocrate (the extra `crate`).
"""

import argparse
import hashlib
import sys
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
from opml.base.files import PROJECT, FilePath, in_project, replacing
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
    """Write the finished run of the present folder into an archive beside its results; return its path.

    configfiles: settings files of the run, in their order
    config: settings of the run beside those files

    Raises InputError where there are no results, or one of the user's own files is missing.
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
        inputs = [_file(crate, settings, "settings.yaml", _setting(crate, workflow))]
        inputs += [_file(crate, path, _place(path)) for path in _inputs(files, values)]
        _add_run(crate, workflow, inputs, [_file(crate, path, _inside(path, results)) for path in products])
        with replacing(archive) as temporary:
            crate.write_zip(temporary)
    return archive


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code: 0, or 1 after one line that tells what is wrong."""
    parser = argparse.ArgumentParser(prog="python -m opml.workflow.crate", description="Pack a finished run.")
    parser.add_argument("--configfile", nargs="*", default=[], help="the files that the run was given")
    parser.add_argument(
        "--config", nargs="*", default=[], metavar="KEY=VALUE", help="settings beside the files"
    )
    options = parser.parse_args(arguments)
    pairs = [setting.partition("=")[::2] for setting in options.config]
    try:
        print(pack(options.configfile, {key: yaml.safe_load(value) for key, value in pairs}))
    except InputError as error:
        print(f"opml: {error}", file=sys.stderr)
        return 1
    return 0


def _described(results: Path, products: Sequence[Path]) -> Any:
    """Return a crate without files, with its title, date, license and profiles."""
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
    """Add the files of the workflow and the packages it needs; return the entity of its Snakefile."""
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
    """Add the settings as the parameter of the workflow; return the properties of their file."""
    parameter = crate.add_formal_parameter("settings", "File", identifier="#settings")
    workflow["input"] = parameter
    return {"name": "All settings of the run", "exampleOfWork": {"@id": parameter.id}}


def _add_run(crate: Any, workflow: Any, inputs: list[Any], products: list[Any]) -> None:
    """Add the run itself: its inputs, its products, and when it ran."""
    paths = [Path(entity.source) for entity in products]
    description = "What the settings ask for, made by Snakemake; times of the first and the last file"
    about = {"name": "Run of the workflow", "description": description}
    about |= {"startTime": _time(paths, min), "endTime": _time(paths, max)}
    run = crate.add_action(workflow, identifier="#run", object=inputs, result=products, properties=about)
    crate.root_dataset["mentions"] = run


def _packages(crate: Any) -> list[Any]:
    """Add this package and all that are installed beside it; return their entities."""
    versions = {package.name: package.version for package in distributions()} | {DISTRIBUTION: __version__}
    return [
        crate.add(
            ContextEntity(crate, f"pkg:pypi/{name}@{number}", _PROGRAM | {"name": name, "version": number})
        )
        for name, number in sorted(versions.items())
    ]


def _inputs(files: Sequence[FilePath], values: Any) -> Iterator[Path]:
    """Yield the user's own files of the run: settings, sheets, orbits, tracks and first states."""
    settings = with_sheets(values)
    named = [*files, *values["sheets"].values(), *settings.starts.values()]
    named += [path for paths in (*settings.orbits.values(), *settings.tracks.values()) for path in paths]
    named += [name for name in values["environment"].values() if Path(str(name)).suffix]
    for path in map(in_project, dict.fromkeys(named)):
        if not path.is_file():
            raise InputError(f"{path}: expected a file that the run was made of, got none")
        yield path


def _place(path: Path) -> str:
    """Return the place of a user's file in the archive: as in the project, or below its last folder."""
    whole, project = path.absolute(), Path.cwd()
    inside = whole.relative_to(project) if whole.is_relative_to(project) else Path(*whole.parts[-2:])
    return f"inputs/{inside.as_posix()}"


def _files(folder: Path) -> Iterator[Path]:
    """Yield all files below a folder in the order of their names, without hidden and compiled ones."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not any(part.startswith((".", "__")) for part in path.parts):
            yield path


def _file(crate: Any, path: Path, to: str, about: dict[str, Any] | None = None) -> Any:
    """Add a file with its size, digest and format; return its entity."""
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    kind = _KINDS.get(path.suffix) or guess_type(path.name)[0] or "application/octet-stream"
    properties = {"sha256": digest, "encodingFormat": kind, **(about or {})}
    return crate.add_file(path, to, record_size=True, properties=properties)


def _inside(path: Path, folder: Path) -> str:
    """Return the path of a file below a folder."""
    return path.relative_to(folder).as_posix()


def _time(paths: Sequence[Path], choose: Any) -> str:
    """Return the first or last time at which files were written, in UTC; choose: `min` or `max`."""
    seconds = choose(path.stat().st_mtime for path in paths)
    return datetime.fromtimestamp(seconds, UTC).isoformat("T", "seconds")


if __name__ == "__main__":
    sys.exit(main())
