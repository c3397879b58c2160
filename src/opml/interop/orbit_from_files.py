"""The files of one orbit, in SP3, CPF or OEM, gathered into arcs and held against each other and the run.

It needs no dynamics, so that a plan can look at files of orbits without loading compiled kernels.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.environment import MARGIN_S
from opml.interop import ccsds, cpf, oem, sp3
from opml.interop.orbit_arcs import MOST_APART, Arc, contents

_Read = Callable[..., list[Arc]]


def check(
    paths: Sequence[FilePath], *, epoch: str, step: float, duration: float, satellite: str | None = None
) -> None:
    """Raise InputError, naming file and line, where no truth could be made of these files.

    A file is missing, damaged or of another format, satellite, frame or time system than the others, or none
    has the orbit within the run. Files are read whole: a second for a month of SP3 every 10 s.
    """
    gathered(paths, epoch=epoch, duration=duration, satellite=satellite)


def gathered(
    paths: Sequence[FilePath], *, epoch: str, duration: float, satellite: str | None = None
) -> list[Arc]:
    """Arcs of all files that reach into the run, by their beginnings. Raises InputError as `check` does."""
    arcs: list[Arc] = []
    first_read: _Read | None = None
    for path in paths:
        content = contents(path)
        read = _reader(path, content)
        if read is not (first_read := first_read or read):
            raise InputError(f"{path}: expected the format of {paths[0]}, got another")
        arcs += read(path, content, epoch=epoch, satellite=satellite)
    for arc in arcs:
        _check_alike(arcs[0], arc)
        _check_spacing(arc)
    arcs = sorted(arcs, key=lambda arc: float(arc.t[0]))
    for before, after in pairwise(arcs):
        if before.t[0] == after.t[0]:
            raise InputError(
                f"{after.path}: expected another beginning than that of {before.path}, got the same"
            )
    return _within_run(arcs, epoch, duration)


def _reader(path: FilePath, content: bytes) -> _Read:
    """What reads a file, by its first line."""
    if sp3.is_one(content):
        return sp3.read
    if cpf.is_one(content):
        return cpf.read
    if oem.is_one(content):
        return _read_oem
    raise InputError(f"{path}: expected an orbit in SP3, CPF or OEM, got neither by its first line")


def _read_oem(path: FilePath, _: bytes, *, epoch: str, satellite: str | None) -> list[Arc]:
    return oem.arcs(path, epoch=epoch, satellite=satellite)


def _check_alike(first: Arc, other: Arc) -> None:
    """Raise InputError where an arc is of another satellite, frame or time system than the first."""
    for what in ("satellite", "frame", "scale"):
        expected, got = getattr(first, what), getattr(other, what)
        if expected.upper() != got.upper():
            name = {"scale": "time system"}.get(what, what)
            raise InputError(f"{other.path}: expected {name} {expected}, as in {first.path}, got {got}")


def _check_spacing(arc: Arc) -> None:
    """Raise InputError where the nodes of an arc are too far from each other, all in all."""
    spacing = float(np.median(np.diff(arc.t))) if len(arc.t) > 1 else 0.0
    if spacing > MOST_APART:
        raise InputError(f"{arc.path}: expected positions at most {MOST_APART:g} s apart, got {spacing:g} s")


def _within_run(arcs: Sequence[Arc], epoch: str, duration: float) -> list[Arc]:
    """Arcs cut to the run and MARGIN_S around it."""
    cut = []
    for arc in arcs:
        inside = (arc.t >= -MARGIN_S) & (arc.t <= duration + MARGIN_S)
        if inside.sum() > 1 and np.any((arc.t[inside] >= 0.0) & (arc.t[inside] <= duration)):
            cut.append(_part(arc, inside))
    if not cut:
        first, last = arcs[0].t[0], max(arc.t[-1] for arc in arcs)
        reach = " to ".join(ccsds.utc_texts(epoch, np.array([first, last])))
        run = f"{epoch} and {duration / DAY:g} days later"
        raise InputError(f"{arcs[0].path}: expected an orbit between {run}, got one from {reach}")
    return cut


def _part(arc: Arc, rows: np.ndarray) -> Arc:
    columns = {name: getattr(arc, name)[rows] for name in ("t", "positions", "velocities", "lines")}
    return Arc(arc.path, arc.satellite, arc.frame, arc.realisation, arc.scale, **columns)
