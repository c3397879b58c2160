"""Orbits as CCSDS orbit ephemeris messages (OEM 2.0, KVN), out and in.

A message holds what a table of opml holds: the truth is one segment, the estimates are one with their
covariances, and each estimate's predictions are a segment of their own. Drag coefficients have no place in an
OEM. Source: CCSDS 502.0-B-2, section 5.
"""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from opml.errors import InputError
from opml.interop import ccsds
from opml.tables import STATE

_KEY = "CCSDS_OEM_VERS"
_VERSIONS = ("1.0", "2.0")
_KILO = 3  # kilometres in the message, metres here
_LOWER = np.tril_indices(6)
_COVARIANCES = [f"cov_{STATE[a]}_{STATE[b]}" for a, b in zip(*_LOWER, strict=True)]

ON_GRID = 1e-6
"""How far from an epoch of the grid a state may lie that stands for the truth there [s]."""


@dataclass(frozen=True)
class Segment:
    """States, and some covariances, of one object.

    t (n,) [s since the epoch]; states (n, 6) GCRF [m, m/s]; covariance_t (m,) [s]; covariances (m, 6, 6) GCRF
    [m, m/s]; lines (n,): where the states stand in the file they were read from.
    """

    name: str
    t: np.ndarray
    states: np.ndarray
    covariance_t: np.ndarray = field(default_factory=lambda: np.empty(0))
    covariances: np.ndarray = field(default_factory=lambda: np.empty((0, 6, 6)))
    remark: str = ""
    lines: np.ndarray = field(default_factory=lambda: np.empty(0, int))


def of_truth(truth: pd.DataFrame, *, rso: str) -> list[Segment]:
    """Segments of a `truth` table: one."""
    return [Segment(rso, truth["t"].to_numpy(), truth[list(STATE)].to_numpy(), remark="true orbit")]


def of_estimates(estimates: pd.DataFrame, *, rso: str) -> list[Segment]:
    """Segments of an `estimates` table: one, with a state and a covariance for each estimate that converged.

    Raises InputError where none did.
    """
    usable = estimates[estimates["converged"]]
    if usable.empty:
        raise InputError(f"{rso}: expected an estimate that converged, got none")
    t, covariances = usable["t"].to_numpy(), np.empty((len(usable), 6, 6))
    covariances[:, _LOWER[0], _LOWER[1]] = covariances[:, _LOWER[1], _LOWER[0]] = usable[_COVARIANCES]
    remark = "estimates at the starts of tracks, not for interpolation"
    return [Segment(rso, t, usable[list(STATE)].to_numpy(), t, covariances, remark)]


def of_predictions(predictions: pd.DataFrame, *, rso: str) -> list[Segment]:
    """Segments of a `predictions` table: one an estimate that has some; failed ones are left out.

    Raises InputError where there is no prediction at all.
    """
    made = predictions[predictions["reason"] == ""]
    if made.empty:
        raise InputError(f"{rso}: expected a prediction, got none")
    return [
        Segment(
            rso,
            rows["t_j"].to_numpy(),
            rows[list(STATE)].to_numpy(),
            remark=f"prediction from the estimate of track {i}",
        )
        for i, rows in made.groupby("i", sort=True)
    ]


SEGMENTS = {"truth": of_truth, "estimates": of_estimates, "predictions": of_predictions}
"""How each table that has a message becomes its segments."""


def write(path: str | os.PathLike, segments: Sequence[Segment], *, epoch: str) -> None:
    """Write segments as an OEM, whole or not at all; `epoch` is the UTC text that their times count from."""
    ccsds.write(path, _lines(segments, epoch))


def read(path: str | os.PathLike, *, epoch: str) -> list[Segment]:
    """Read the segments of an OEM, with times from the UTC text `epoch`.

    Time systems: `ccsds.SCALES`; frames: `ccsds.FRAMES`, turned to GCRF. Accelerations are passed over.
    Raises InputError, naming file and line, for what is malformed, not centred on Earth or in another frame.
    """
    message = ccsds.Message(path, version_key=_KEY, versions=_VERSIONS)
    while message.peek() and message.peek() != "META_START":
        message.pair()
    segments = []
    while message.peek() or not segments:
        segments.append(_segment(message, epoch))
    return segments


def truth_table(path: str | os.PathLike, *, epoch: str, step: float, duration: float) -> pd.DataFrame:
    """The `truth` table of an OEM: GCRF states every `step` from the epoch to `duration` [s].

    The message may reach further, but the states within have to lie on that grid, as nothing is interpolated.
    Raises InputError, naming the file and the epoch that is missing or off the grid.
    """
    segments = read(path, epoch=epoch)
    t, lines = (np.concatenate([getattr(s, name) for s in segments]) for name in ("t", "lines"))
    back = np.flatnonzero(np.diff(t) <= 0.0)
    if back.size:
        raise InputError(f"{path}: line {lines[back[0] + 1]}: expected a later epoch than before, got none")
    inside = (t >= -ON_GRID) & (t <= duration + ON_GRID)
    index = np.rint(t[inside] / step).astype(int)
    off = np.flatnonzero(np.abs(t[inside] - index * step) > ON_GRID)
    if off.size:
        at, number = t[inside][off[0]], lines[inside][off[0]]
        raise InputError(
            f"{path}: line {number}: expected an epoch every {step:g} s from {epoch}, got {at:.6f} s after it"
        )
    grid = np.arange(0.0, duration + 0.5 * step, step)
    missing = np.setdiff1d(np.arange(len(grid)), index)
    if missing.size:
        at = ccsds.utc(epoch, grid[missing[:1]])[0]
        raise InputError(f"{path}: expected a state every {step:g} s up to {grid[-1]:g} s, got none at {at}")
    states = np.concatenate([segment.states for segment in segments])[inside]
    return pd.DataFrame({"t": grid, **dict(zip(STATE, states.T, strict=True))})


def _lines(segments: Sequence[Segment], epoch: str) -> Iterator[str]:
    yield from ccsds.header(_KEY, epoch)
    for segment in segments:
        times = ccsds.utc(epoch, segment.t)
        yield ""
        yield "META_START"
        if segment.remark:
            yield f"COMMENT {segment.remark}"
        yield f"OBJECT_NAME = {segment.name}"
        yield f"OBJECT_ID = {segment.name}"
        yield "CENTER_NAME = EARTH"
        yield "REF_FRAME = GCRF"
        yield "TIME_SYSTEM = UTC"
        yield f"START_TIME = {times[0]}"
        yield f"STOP_TIME = {times[-1]}"
        yield "META_STOP"
        for time, state in zip(times, segment.states.tolist(), strict=True):
            yield " ".join([time, *(ccsds.printed(value, -_KILO) for value in state)])
        if len(segment.covariances):
            yield from _covariance_lines(segment, epoch)


def _covariance_lines(segment: Segment, epoch: str) -> Iterator[str]:
    yield "COVARIANCE_START"
    times = ccsds.utc(epoch, segment.covariance_t)
    for time, covariance in zip(times, segment.covariances, strict=True):
        yield f"EPOCH = {time}"
        yield "COV_REF_FRAME = GCRF"
        for k in range(6):
            yield " ".join(ccsds.printed(value, -2 * _KILO) for value in covariance[k, : k + 1])
    yield "COVARIANCE_STOP"


def _segment(message: ccsds.Message, epoch: str) -> Segment:
    message.expect("META_START")
    metadata = message.pairs("META_STOP")
    metadata.one_of("CENTER_NAME", ("EARTH",))
    frame = metadata.one_of("REF_FRAME", tuple(ccsds.FRAMES))
    scale = metadata.one_of("TIME_SYSTEM", ccsds.SCALES)
    numbers, times, states = [], [], []
    while message.peek() not in ("", "META_START", "COVARIANCE_START"):
        number, line = message.take()
        time, *values = line.split()
        if len(values) not in (6, 9):
            raise message.wrong("a time, position and velocity", line, number)
        states.append([message.scaled(value, _KILO, number) for value in values[:6]])
        numbers.append(number)
        times.append(time)
    if not states:
        raise message.wrong("a state", message.peek())
    covariance_t, covariances = _covariances(message, frame, scale, epoch)
    return Segment(
        name=metadata.text("OBJECT_NAME"),
        t=message.elapsed(times, numbers, epoch=epoch, scale=scale),
        states=np.array(states) @ _of_states(frame).T,
        covariance_t=covariance_t,
        covariances=covariances,
        lines=np.array(numbers),
    )


def _covariances(message, frame, scale, epoch):
    """Times (m,) [s] and covariances (m, 6, 6) in GCRF of the block that may follow the states."""
    numbers, times, covariances = [], [], []
    if message.peek() == "COVARIANCE_START":
        message.take()
        while message.peek() != "COVARIANCE_STOP":
            number, key, value = message.pair()
            if key != "EPOCH":
                raise message.wrong("EPOCH = time", f"{key} = {value}", number)
            numbers.append(number)
            times.append(value)
            if message.peek().startswith("COV_REF_FRAME"):
                number, _, frame = message.pair()
                if frame not in ccsds.FRAMES:
                    raise message.wrong(f"COV_REF_FRAME = {' or '.join(ccsds.FRAMES)}", frame, number)
            turn = _of_states(frame)
            covariances.append(turn @ _covariance(message) @ turn.T)
        message.take()
    shape = (len(covariances), 6, 6)
    return message.elapsed(times, numbers, epoch=epoch, scale=scale), np.reshape(covariances, shape)


def _covariance(message):
    """A covariance (6, 6) from the lines of its lower triangle."""
    covariance = np.empty((6, 6))
    for k in range(6):
        number, line = message.take()
        values = line.split()
        if len(values) != k + 1:
            raise message.wrong(f"row {k + 1} of a covariance's lower triangle", line, number)
        row = [message.scaled(value, 2 * _KILO, number) for value in values]
        covariance[k, : k + 1] = covariance[: k + 1, k] = row
    return covariance


def _of_states(frame: str) -> np.ndarray:
    """Rotation (6, 6) of states in a frame to GCRF."""
    return np.kron(np.eye(2), ccsds.FRAMES[frame])
