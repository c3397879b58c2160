"""Writer and readers of orbits as CCSDS orbit ephemeris messages (OEM 2.0, KVN).

A message holds a table of opml: the truth is one segment, and each corrected ephemeris is one. An OEM has no
drag coefficients.
Source: CCSDS 502.0-B-2, section 5.
"""

import logging
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds
from opml.interop.element_sets.teme import teme_to_gcrf, tod_to_gcrf
from opml.interop.ephemeris import Ephemeris
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import MOST_APART, Arc, check_ascending, choose_satellites
from opml.orbits.density_error import DensityErrors
from opml.tables import STATE, STATE_COVARIANCES, symmetric_matrices

_KEY = "CCSDS_OEM_VERS"
_VERSIONS = ("1.0", "2.0", "3.0")
_KILO = 3  # kilometres in the message, metres here
_LOWER = np.tril_indices(6)

_RSW = "RSW"
_log = logging.getLogger(__name__)
_SENSITIVITY = "DCP_SENSITIVITY_VECTOR"
_DENSITY_KEYS = {
    ccsds.DENSITY_COMMENT: ccsds.DENSITY_KEY,
    "DCP Sensitivity Vector RTN [m, m/s]": _SENSITIVITY,
}
"""What comments before the covariances have: the uncertainty, and a time with its vector in each line."""

_AXES_ONLY = "covariances in RSW: axes of the states only, velocities are inertial, not in a turning frame"
_COVARIANCE_STEP = 600.0
"""Time between covariances of an ephemeris [s]: they change over hours, and are twice as long as a state."""

_DEGREE = 7  # of the interpolation; a state each minute is then good to a millimetre
_OF_DATE = {"TEME": teme_to_gcrf, "TOD": tod_to_gcrf}
_FRAMES = (*ccsds.FRAMES, *_OF_DATE, "ITRF")
_AXES = {
    **dict.fromkeys((*ccsds.FRAMES, *_OF_DATE), "GCRF"),
    **dict.fromkeys(("RSW", "RTN", "RIC"), _RSW),
    "TNW": "TNW",
}
"""Axes of covariances by the names of their frames; others cost the covariances."""

_TERRESTRIAL = re.compile(r"ITRF[-_]?\d*", re.IGNORECASE)


def truth_segments(truth: pd.DataFrame, *, rso: str) -> list[Ephemeris]:
    """Return the segment of a table `truth`."""
    t = truth["t"].to_numpy()
    return [Ephemeris(rso, t, truth[STATE].to_numpy(), remark="true orbit", known=t[-1])]


def corrected_segments(corrected: pd.DataFrame, *, rso: str) -> list[Ephemeris]:
    """Return the segments of a table `corrected`, one per estimate, with a covariance every ten minutes."""
    segments = []
    for i, rows in corrected.groupby("i", sort=True):
        t = rows["t"].to_numpy()
        every = max(1, round(_COVARIANCE_STEP / float(np.median(np.diff(t)))))
        sparse = np.unique(np.append(np.arange(0, len(t), every), len(t) - 1))
        segments.append(
            Ephemeris(
                rso,
                t,
                rows[STATE].to_numpy(),
                t[sparse],
                symmetric_matrices(rows.iloc[sparse], STATE_COVARIANCES),
                covariance_frame=_RSW,
                remark=f"corrected prediction from the estimate of track {i}",
                degree=_DEGREE,
            )
        )
    return segments


SEGMENTS: dict[str, Callable[..., list[Ephemeris]]] = {
    "truth": truth_segments,
    "corrected": corrected_segments,
}
"""Makers of the segments of a message, by the table."""


def segments_of(table: pd.DataFrame, kind: str, identity: ObjectId) -> list[Ephemeris]:
    """Return the segments of a table of a kind, of an object by its name in the run."""
    return [replace(segment, identity=identity) for segment in SEGMENTS[kind](table, rso=identity.name)]


def write(path: FilePath, segments: Sequence[Ephemeris], *, epoch: str, comment: str = "") -> None:
    """Write segments as an OEM, whole or not at all."""
    ccsds.write(path, _lines(segments, epoch, comment))


def read(path: FilePath, _: bytes, *, epoch: str, satellite: str | None = None) -> list[Arc]:
    """Read the arcs of an object in an OEM, one per segment, with their covariances.

    satellite: as in `choose_satellites`, a name or an id of the object

    The message may use the time systems of `ccsds.SCALES`, the frames of `ccsds.FRAMES`, TEME, TOD and
    realisations of the ITRF; TEME and TOD are of REF_FRAME_EPOCH where there is one. States outside the
    useable times are left out, accelerations are ignored, and covariances in other axes are passed over, and
    logged. Raises InputError, naming the line, for a malformed or truncated message, one that is not centred
    on Earth, another frame, times that do not ascend and negative variances.
    """
    message = ccsds.Message(path, version_key=_KEY, versions=_VERSIONS, in_comments=_DENSITY_KEYS)
    segments = []
    for header in message.segments():
        names, arc = _named_arc(message, epoch)
        known = header.time("CREATION_DATE", np.nan, epoch=epoch, scale="UTC")
        segments.append((names, replace(arc, known=None if np.isnan(known) else known)))
    objects = list(dict.fromkeys(names for names, _ in segments))
    wanted = [objects[k] for k in choose_satellites(path, objects, satellite)]
    arcs = [arc for names, arc in segments if names in wanted and arc.t.size]
    if not arcs:
        raise InputError(f"{path}: expected states within the useable times, got none")
    return arcs


def _lines(segments: Sequence[Ephemeris], epoch: str, comment: str) -> Iterator[str]:
    version, *rest = ccsds.header(_KEY, epoch, max(segment.newest for segment in segments))
    yield from (version, *([f"COMMENT {comment}"] if comment else []), *rest)
    for segment in segments:
        times = ccsds.utc_texts(epoch, segment.t)
        yield from ("", "META_START", *([f"COMMENT {segment.remark}"] if segment.remark else []))
        yield f"OBJECT_NAME = {segment.name}"
        yield f"OBJECT_ID = {segment.identity.identifier or segment.name}"
        yield from ("CENTER_NAME = EARTH", "REF_FRAME = GCRF", "TIME_SYSTEM = UTC")
        yield f"START_TIME = {times[0]}"
        yield f"STOP_TIME = {times[-1]}"
        if segment.degree:
            yield "INTERPOLATION = HERMITE"
            yield f"INTERPOLATION_DEGREE = {segment.degree}"
        yield "META_STOP"
        yield from ccsds.lines(times, segment.states, -_KILO)
        if len(segment.covariances):
            yield from _covariance_lines(segment, epoch)


def _covariance_lines(segment: Ephemeris, epoch: str) -> Iterator[str]:
    yield "COVARIANCE_START"
    if segment.covariance_frame == _RSW:
        yield f"COMMENT {_AXES_ONLY}"
    if segment.density is not None:
        yield from _density_lines(segment.density, epoch)
    times = ccsds.utc_texts(epoch, segment.covariance_t)
    texts = iter(ccsds.number_texts(segment.covariances[:, *_LOWER].ravel(), -2 * _KILO))
    for time in times:
        yield f"EPOCH = {time}"
        yield f"COV_REF_FRAME = {segment.covariance_frame}"
        yield from (" ".join(islice(texts, k + 1)) for k in range(6))
    yield "COVARIANCE_STOP"


def _density_lines(density: DensityErrors, epoch: str) -> Iterator[str]:
    uncertainty, sensitivity = _DENSITY_KEYS
    yield f"COMMENT {uncertainty} = {density.uncertainty!r}"
    for time, numbers in zip(ccsds.utc_texts(epoch, density.t), density.sensitivities.tolist(), strict=True):
        yield f"COMMENT {sensitivity} = {time} {' '.join(map(repr, numbers))}"


def _named_arc(message: ccsds.Message, epoch: str) -> tuple[tuple[str, str], Arc]:
    """Return name and id of a segment's object, and the arc of its states, with their covariances."""
    metadata = message.metadata()
    metadata.choice("CENTER_NAME", ("EARTH",))
    scale = metadata.choice("TIME_SYSTEM", ccsds.SCALES)
    t, states, lines = _states(message, metadata, scale, epoch)
    begin = metadata.time("USEABLE_START_TIME", t[0], epoch=epoch, scale=scale)
    end = metadata.time("USEABLE_STOP_TIME", t[-1], epoch=epoch, scale=scale)
    useable = (begin <= t) & (t <= end)
    realisation, name = metadata.text("REF_FRAME"), metadata.text("OBJECT_NAME")
    frame = "ITRF" if _TERRESTRIAL.fullmatch(realisation) else metadata.choice("REF_FRAME", _FRAMES)
    covariance_t, covariances, axes, density = _covariances(message, frame, scale, epoch)
    if beyond := int(np.count_nonzero((covariance_t < t[0]) | (covariance_t > t[-1]))):
        _log.warning("%s: covariances of times outside those of the states: %d", message.path, beyond)
    if frame in _OF_DATE:
        of = metadata.time("REF_FRAME_EPOCH", np.nan, epoch=epoch, scale=scale)
        states = np.einsum("nij,nj->ni", _turns(frame, epoch, np.where(np.isnan(of), t, of)), states)
        frame = "GCRF"
    number = metadata.text("OBJECT_ID", name)
    arc = Arc(
        path=message.path,
        satellite=name,
        frame=frame,
        realisation=realisation,
        scale=scale,
        t=t[useable],
        positions=states[useable, :3],
        velocities=states[useable, 3:],
        lines=lines[useable],
        identity=ObjectId.of(name, metadata.text("OBJECT_ID", "")),
        covariance_t=covariance_t,
        covariances=covariances,
        covariance_frame=axes,
        density=density,
    )
    return (name, number), arc


def _states(
    message: ccsds.Message, metadata: ccsds.KeyValues, scale: str, epoch: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times (n,) [s], states (n, 6) [m, m/s] in their frame, and lines (n,) of a segment.

    Raises InputError where it has none, or is cut.
    """
    lines, times, states = [], [], []
    while not message.is_over and message.peek() not in ("META_START", "COVARIANCE_START"):
        number, line = message.take()
        time, *values = line.split()
        if len(values) not in (6, 9):
            raise message.error("a time, position and velocity", line, number)
        lines.append(number)
        times.append(time)
        states.append([ccsds.scaled(message.path, number, text, _KILO) for text in values[:6]])
    if not lines:
        raise message.error("a state", message.peek())
    t = ccsds.times(message.path, lines, times, epoch=epoch, scale=scale)
    check_ascending(message.path, t, np.array(lines))
    if t[-1] < metadata.time("STOP_TIME", t[-1], epoch=epoch, scale=scale) - MOST_APART:  # the file is cut
        raise message.error(f"states up to STOP_TIME = {metadata.text('STOP_TIME')}", times[-1], lines[-1])
    return t, np.array(states), np.array(lines)


def _covariances(
    message: ccsds.Message, frame: str, scale: str, epoch: str
) -> tuple[np.ndarray, np.ndarray, str | np.ndarray, DensityErrors | None]:
    """Return times, covariances in GCRF or axes of the states, these axes, and errors of the density.

    frame: of the states, which counts for covariances that name none
    """
    numbers, times, covariances, frames = [], [], [], []
    density = None
    if message.peek() == "COVARIANCE_START":
        message.take()
        density = _density(message, scale, epoch)
        while message.peek() != "COVARIANCE_STOP":
            number, key, value = message.pair()
            if key != "EPOCH":
                raise message.error("EPOCH = time", f"{key} = {value}", number)
            numbers.append(number)
            times.append(value)
            has_frame = message.peek().startswith("COV_REF_FRAME")
            frames.append(message.pair()[2].upper().removesuffix("_INERTIAL") if has_frame else frame)
            covariances.append(_covariance(message))
        message.take()
    t = ccsds.times(message.path, numbers, times, epoch=epoch, scale=scale)
    check_ascending(message.path, t, np.array(numbers))
    axes = np.array([_AXES.get(own, "") for own in frames], dtype=str)
    if (wrong := np.flatnonzero(axes == "")).size:
        warning = "%s: line %d: covariances left out: %d: expected COV_REF_FRAME = %s, got %s"
        first = int(wrong[0])
        _log.warning(warning, message.path, numbers[first], wrong.size, " or ".join(_AXES), frames[first])
    for own in {frame for frame in frames if _AXES.get(frame) == "GCRF"}:
        rows = [k for k, frame in enumerate(frames) if frame == own]
        for k, turn in zip(rows, _turns(own, epoch, t[rows]), strict=True):
            covariances[k] = turn @ covariances[k] @ turn.T
    kept = np.flatnonzero(axes != "")
    known = np.reshape(covariances, (len(t), 6, 6))[kept]
    alike = str(axes[kept[0]]) if len(set(axes[kept])) == 1 else axes[kept]
    return t[kept], known, alike if kept.size else "GCRF", density if kept.size else None


def _density(message: ccsds.Message, scale: str, epoch: str) -> DensityErrors | None:
    """Return what comments before the covariances show about the density, None where they say nothing."""
    if not message.peek().startswith(ccsds.DENSITY_KEY):
        return None
    number, _, value = message.pair()
    uncertainty = ccsds.scaled(message.path, number, value, 0)
    numbers, times, sensitivities = [], [], []
    while message.peek().startswith(_SENSITIVITY):
        number, _, value = message.pair()
        time, *texts = value.split()
        if len(texts) != len(STATE):
            raise message.error("a time and six numbers of sensitivity", value, number)
        numbers.append(number)
        times.append(time)
        sensitivities.append([ccsds.scaled(message.path, number, text, 0) for text in texts])
    if not times:
        raise message.error(f"{_SENSITIVITY} after the uncertainty of the density", message.peek())
    t = ccsds.times(message.path, numbers, times, epoch=epoch, scale=scale)
    check_ascending(message.path, t, np.array(numbers))
    return DensityErrors(uncertainty, t, np.array(sensitivities))


def _covariance(message: ccsds.Message) -> np.ndarray:
    covariance = np.empty((6, 6))
    for k in range(6):
        number, line = message.take()
        values = line.split()
        if len(values) != k + 1:
            raise message.error(f"row {k + 1} of a covariance's lower triangle", line, number)
        row = [ccsds.scaled(message.path, number, value, 2 * _KILO) for value in values]
        if row[-1] < 0.0:
            raise message.error("a variance of 0 or more", values[-1], number)
        covariance[k, : k + 1] = covariance[: k + 1, k] = row
    ccsds.check_correlations(message.path, number, covariance)
    return covariance


def _turns(frame: str, epoch: str, t: np.ndarray) -> np.ndarray:
    """Return the rotations (n, 6, 6) of states in a frame at times (n,) [s] to GCRF."""
    turns = _OF_DATE[frame](epoch, t) if frame in _OF_DATE else np.tile(ccsds.FRAMES[frame], (len(t), 1, 1))
    return np.kron(np.eye(2), turns)
