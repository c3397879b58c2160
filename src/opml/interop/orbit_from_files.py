"""Reader of an orbit from files in any of its formats: arcs, checked against each other and the run.

It needs no dynamics, so that a plan can check files of orbits without loading compiled kernels.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from opml.base.constants import DAY, WGS84_A, WGS84_F
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.environment import MARGIN_S
from opml.interop import ccsds, formats
from opml.interop.orbit_arcs import MOST_APART, Arc, contents

_NEAREST, _FARTHEST = WGS84_A * (1.0 - WGS84_F), 600e6
"""Distances of a satellite from the Earth's centre [m]; others are in another unit."""


@dataclass(frozen=True)
class OrbitFiles:
    """Files of a satellite's orbit over a run."""

    paths: Sequence[FilePath]  # of one format, in any order
    epoch: str  # of the run, UTC text
    duration: float  # of the run [s]
    satellite: str | None = None  # name or id in the files; None: the files have only one


def read_arcs(files: OrbitFiles) -> list[Arc]:
    """Read the arcs that reach into the run, in the order of their beginnings.

    Raises InputError as `arcs_of_files` does, for nodes that are too far apart, and for files without the
    orbit within the run.
    """
    arcs = arcs_of_files(files)
    for arc in arcs:
        spacing = float(np.median(np.diff(arc.t))) if len(arc.t) > 1 else 0.0
        if spacing > MOST_APART:
            raise InputError(
                f"{arc.path}: expected positions at most {MOST_APART:g} s apart, got {spacing:g} s"
            )
    return _cut_to_run(arcs, files)


def arcs_of_files(files: OrbitFiles) -> list[Arc]:
    """Read the arcs of files, in the order of their beginnings, whether in the run or not.

    Raises InputError, naming file and line, for a missing or damaged file, one of another format, satellite,
    frame or time system than the others, and one in another unit.
    """
    arcs: list[Arc] = []
    first = None
    for path in dict.fromkeys(files.paths):
        content = contents(path)
        first = first or formats.of(path, content, formats.ORBIT)
        if (own := formats.of(path, content, formats.ORBIT)) is not first:
            raise InputError(f"{path}: expected {first.name}, as {files.paths[0]}, got {own.name}")
        arcs += formats.read(path, content, formats.ORBIT, epoch=files.epoch, satellite=files.satellite)
    check_together(arcs)
    return sorted(arcs, key=lambda arc: float(arc.t[0]))


def check_together(arcs: Sequence[Arc]) -> None:
    """Raise InputError, naming the file, for arcs that are not of one orbit.

    These are one of another satellite, frame or time system than the first, one in another unit, and one that
    begins where another does.
    """
    for arc in arcs:
        _check_alike(arcs[0], arc)
        radii = np.linalg.norm(arc.positions, axis=1)
        wrong = np.flatnonzero((radii < _NEAREST) | (radii > _FARTHEST))
        if wrong.size:
            expected = f"positions {_NEAREST / 1e3:.0f} to {_FARTHEST / 1e3:.0f} km from the Earth's centre"
            got = f"{radii[wrong[0]] / 1e3:.6g} km: is the unit right?"
            raise InputError(f"{arc.path}: line {arc.lines[wrong[0]]}: expected {expected}, got {got}")
    for before, after in pairwise(sorted(arcs, key=lambda arc: float(arc.t[0]))):
        if before.t[0] == after.t[0]:
            raise InputError(
                f"{after.path}: expected another beginning than that of {before.path}, got the same"
            )


def _check_alike(first: Arc, other: Arc) -> None:
    if not first.owner.is_same(other.owner):
        expected = f"satellite {first.owner}, as in {first.path}"
        raise InputError(f"{other.path}: expected {expected}, got {other.owner}")
    for name, expected, got in (
        ("frame", first.frame, other.frame),
        ("time system", first.scale, other.scale),
    ):
        if expected != got:
            raise InputError(f"{other.path}: expected {name} {expected}, as in {first.path}, got {got}")


def _cut_to_run(arcs: Sequence[Arc], files: OrbitFiles) -> list[Arc]:
    """Return the arcs within the run and MARGIN_S around it. Raises InputError where none is left."""
    cut = []
    for arc in arcs:
        inside = (arc.t >= -MARGIN_S) & (arc.t <= files.duration + MARGIN_S)
        if inside.sum() > 1 and np.any((arc.t[inside] >= 0.0) & (arc.t[inside] <= files.duration)):
            cut.append(arc.part(inside))
    if not cut:
        raise outside(arcs, files)
    return cut


def outside(arcs: Sequence[Arc], files: OrbitFiles) -> InputError:
    """Return the error of arcs of which nothing is within the run."""
    first, last = arcs[0].t[0], max(arc.t[-1] for arc in arcs)
    reach = " to ".join(ccsds.utc_texts(files.epoch, np.array([first, last])))
    run = f"{files.epoch} and {files.duration / DAY:g} days later"
    return InputError(f"{arcs[0].path}: expected an orbit between {run}, got one from {reach}")
