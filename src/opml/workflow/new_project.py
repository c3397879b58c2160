"""A new project: the workflow, its settings and a first study, written into a folder."""

import os
import shlex
import shutil
import tempfile
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from opml.base.errors import InputError
from opml.base.files import PROJECT, FilePath, writable
from opml.study.settings import editor_schema

STUDY = "mine.yaml"
"""The file of the study that a new project begins with: one satellite, two radars, eighteen days."""

STUDY_COMMAND = f"snakemake -j2 study --configfile {STUDY}"
"""Runs the study of a project that has one."""

SIMULATED = """\
# mine.yaml
# yaml-language-server: $schema=workflow/schemas/config.schema.json
results: results/mine
duration_days: 18
estimation: {window_hours: 24}
rsos:
  mine: {a_km: 6900, e: 0.001, i_deg: 97.5, argp_deg: 0, raan_deg: 120, mean_anomaly_deg: 0,
         area_to_mass_m2pkg: 0.02, cd: 2.2, cr: 1.25}
study:
  rsos: [mine]
  station_sets: [eglin-kaena]
  days: {train: [0, 10], test: [10, 18]}
"""


def write(folder: FilePath, study: str = SIMULATED, others: Sequence[Path] = ()) -> None:
    """Write the workflow, its settings and a study into a folder, which is made where there is none.

    study: YAML; others: files that it reads

    Raises InputError for no name, for that of a file, and where the folder holds a file or folder of a
    project's; nothing is written then.
    """
    if not str(folder).strip():
        raise InputError(f"init: expected a folder, got {str(folder)!r}; . is this one")
    folder = Path(folder)
    if folder.is_file():
        raise InputError(f"{folder}: expected a folder, got a file")
    parts = sorted(PROJECT.iterdir())
    others = [path for path in others if path.resolve() != (folder / path.name).resolve()]
    names = [*(part.name for part in (*parts, *others)), STUDY]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name}: expected another name than that of a project's own file")
        if (folder / name).exists():
            raise InputError(f"{folder / name}: expected a folder without a project, got one that has this")
    with writable(folder):
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".new.", dir=folder) as temporary:
            for part in (*parts, *others):
                _copy(part, Path(temporary, part.name))
            editor_schema.write(temporary)
            Path(temporary, STUDY).write_text(study, encoding="utf-8")
            for name in names:
                os.replace(Path(temporary, name), folder / name)


BEFORE = ".before"  # added to the names of a project's own files when an upgrade replaces them


def upgrade(folder: FilePath) -> None:
    """Give a project the workflow and the settings of this version, and keep its sheets, studies and results.

    What it had stays beside under names that end in BEFORE. Raises InputError for a folder without a project,
    and where an earlier upgrade left such names; nothing is written then.
    """
    parts = [(part, Path(folder, part.name)) for part in sorted(PROJECT.iterdir())]
    for _, own in parts:
        if not own.exists():
            raise InputError(f"{own}: expected a project of `opml init`, got none")
        if (former := own.with_name(own.name + BEFORE)).exists():
            raise InputError(f"{former}: expected none: remove what an earlier upgrade replaced")
    with writable(folder), tempfile.TemporaryDirectory(prefix=".new.", dir=folder) as temporary:
        for part, own in parts:
            _copy(part, Path(temporary, own.name))
        editor_schema.write(temporary)
        for sheet in Path(folder, "config").glob("*.tsv"):
            shutil.copyfile(sheet, Path(temporary, "config", sheet.name))
        for _, own in parts:
            os.replace(own, own.with_name(own.name + BEFORE))
            os.replace(Path(temporary, own.name), own)


def next_steps(folder: str, command: str = STUDY_COMMAND) -> str:
    """Return the commands that run a new project, and the one that prints how to go on."""
    install = [] if find_spec("snakemake") else ["pip install 'opml-orbits[workflow]'"]
    return "\n".join([*install, f"cd {shlex.quote(folder)}", command, "opml docs howto"])


def _copy(part: Path, to: Path) -> None:
    """Copy a file, or the files of a folder."""
    for file in (part, *part.rglob("*")):
        if file.is_file() and "__pycache__" not in file.parts:
            copy = to / file.relative_to(part)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy)
