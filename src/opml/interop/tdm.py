"""Writer and reader of tracks as CCSDS tracking data messages (TDM 1.0 and 2.0, KVN).

The writer makes a segment of azimuth, elevation and range for each station and track. The reader takes
messages of any software; the station is the participant that receives, the last one in the path.
Measurements count as geometric: the range is the distance at the time tag, one way.
Source: CCSDS 503.0-B-2.
"""

import re
from collections.abc import Iterator, Sequence
from itertools import count

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds
from opml.orbits.elements import wrap_turn

_KEY = "CCSDS_TDM_VERS"
_VERSIONS = ("1.0", "2.0")
_KILO = 3  # kilometres in the message, metres here
_TYPES = ("ANGLE_1", "ANGLE_2", "RANGE")
_PATHS = ("2,1", "1,2", "1,2,1", "2,1,2")
"""Paths for reading: from the other participant to the receiver, or there and back."""

_PASSED_OVER = re.compile(
    r"CARRIER_POWER|CLOCK_(BIAS|DRIFT)|DOPPLER_(INSTANTANEOUS|INTEGRATED|COUNT)|DOR|MAG|P[CR]_N0|PRESSURE|RCS"
    r"|(RECEIVE|TRANSMIT)_(FREQ|FREQ_RATE|PHASE_CT)(_\d)?|RHUMIDITY|STEC|TEMPERATURE|TROPO_(DRY|WET)"
    r"|VLBI_DELAY"
)
"""Types of data that the estimation does not use."""

COLUMNS = ["track", "t", "station", "azimuth", "elevation", "range"]
"""Columns of the table `tracking` in a message, which has no noise-free values."""


def write(path: FilePath, tracking: pd.DataFrame, *, epoch: str, rso: str) -> None:
    """Write the measurements of a table `tracking` as a TDM, whole or not at all.

    epoch: UTC text from which the table's times count
    rso: name of the RSO
    """
    ccsds.write(path, _lines(tracking, epoch, rso))


def read(path: FilePath, *, epoch: str) -> pd.DataFrame:
    """Read the measurements of a TDM in order of time, as a table of `COLUMNS`.

    epoch: UTC text from which times count

    Tracks are numbered from 0 by time. A track is all segments of a TRACK_ID, or a segment without TRACK_ID.
    Raises InputError as `measurements` does.
    """
    table = measurements([path], epoch=epoch).sort_values("t", kind="stable", ignore_index=True)
    segment = "segment " + table["segment"].astype(str)
    table["track"] = pd.factorize(table["track_id"].where(table["track_id"] != "", segment))[0]
    return table[COLUMNS]


def measurements(paths: Sequence[FilePath], *, epoch: str) -> pd.DataFrame:
    """Read the measurements of TDMs of one RSO, in the order of the files.

    epoch: UTC text

    Columns: t [s since `epoch`]; azimuth, elevation [rad]; range [m]; station and rso, the names in the file;
    scale, the time system; track_id, empty without TRACK_ID; segment, numbered through all files; path and
    line. Raises InputError, naming file and line, for a malformed message, an epoch without all three
    measurements, other units and paths, and an RSO or time system that differs from the first.
    """
    segments: list[pd.DataFrame] = []
    numbers = count()
    for path in paths:
        message = ccsds.Message(path, version_key=_KEY, versions=_VERSIONS)
        message.skip_header()
        segments.append(_segment(message, epoch, next(numbers)))
        while message.peek():
            segments.append(_segment(message, epoch, next(numbers)))
    table = pd.concat(segments, ignore_index=True)
    if table.empty:
        raise InputError(f"{paths[0]}: expected azimuth, elevation and range, got none")
    _check_alike(table)
    return table


def _lines(tracking: pd.DataFrame, epoch: str, rso: str) -> Iterator[str]:
    yield from ccsds.header(_KEY, epoch)
    for (track, station), rows in tracking.groupby(["track", "station"], sort=False):
        times = ccsds.utc_texts(epoch, rows["t"].to_numpy())
        yield ""
        yield "META_START"
        yield "COMMENT geometric measurements: no light time, no aberration, no refraction"
        yield f"TRACK_ID = {track}"
        yield f"DATA_TYPES = {','.join(_TYPES)}"
        yield "TIME_SYSTEM = UTC"
        yield f"START_TIME = {times[0]}"
        yield f"STOP_TIME = {times[-1]}"
        yield f"PARTICIPANT_1 = {station}"
        yield f"PARTICIPANT_2 = {rso}"
        yield "MODE = SEQUENTIAL"
        yield "PATH = 2,1"
        yield "RANGE_UNITS = km"
        yield "ANGLE_TYPE = AZEL"
        yield "META_STOP"
        yield "DATA_START"
        values = rows[["azimuth", "elevation", "range"]].to_numpy().tolist()
        for time, (azimuth, elevation, distance) in zip(times, values, strict=True):
            yield f"ANGLE_1 = {time} {ccsds.degrees_text(azimuth)}"
            yield f"ANGLE_2 = {time} {ccsds.degrees_text(elevation)}"
            yield f"RANGE = {time} {ccsds.number_text(distance, -_KILO)}"
        yield "DATA_STOP"


def _segment(message: ccsds.Message, epoch: str, number: int) -> pd.DataFrame:
    """Return the measurements of a segment; an empty table where it holds other types of data only."""
    message.expect("META_START")
    metadata = message.pairs("META_STOP")
    data = _data(message)
    if not data:
        return pd.DataFrame()
    station, rso = _participants(metadata)
    metadata.choice("ANGLE_TYPE", ("AZEL",))
    metadata.choice("RANGE_UNITS", ("KM",), default="km")
    scale = metadata.choice("TIME_SYSTEM", ccsds.SCALES)
    lines = [next(iter(measured.values()))[1] for measured in data.values()]
    values = np.array([[measured[kind][0] for kind in _TYPES] for measured in data.values()])
    values += _corrections(message, metadata)
    return pd.DataFrame(
        {
            "t": message.times(list(data), lines, epoch=epoch, scale=scale),
            "station": station,
            "rso": rso,
            "scale": scale,
            "azimuth": wrap_turn(values[:, 0]),
            "elevation": values[:, 1],
            "range": values[:, 2],
            "track_id": metadata.text("TRACK_ID", ""),
            "segment": number,
            "path": str(message.path),
            "line": lines,
        }
    )


def _participants(metadata: ccsds.Pairs) -> tuple[str, str]:
    """Return the names of the station, which receives, and of the RSO."""
    metadata.choice("MODE", ("SEQUENTIAL",), default="SEQUENTIAL")
    receiver = metadata.choice("PATH", _PATHS)[-1]
    other = "2" if receiver == "1" else "1"
    return metadata.text(f"PARTICIPANT_{receiver}"), metadata.text(f"PARTICIPANT_{other}")


def _corrections(message: ccsds.Message, metadata: ccsds.Pairs) -> np.ndarray:
    """Return the corrections that are not applied yet to each type of a segment (3,) [rad, rad, m]."""
    texts = [metadata.text(f"CORRECTION_{kind}", "") for kind in _TYPES]
    if not any(texts) or metadata.choice("CORRECTIONS_APPLIED", ("YES", "NO")) == "YES":
        return np.zeros(3)
    numbers = [metadata.line(f"CORRECTION_{kind}") for kind in _TYPES]
    return np.array(
        [_value(message, k, text or "0", n) for k, text, n in zip(_TYPES, texts, numbers, strict=True)]
    )


def _value(message: ccsds.Message, kind: str, text: str, number: int) -> float:
    """Return a measurement [rad, m] from its text in degrees or kilometres."""
    if kind == "RANGE":
        return message.scale(text, _KILO, number)
    angle = message.radians(text, number)
    if abs(angle) > 2.0 * np.pi:
        raise message.error("an angle of -360 to 360 deg", text, number)
    return angle


def _data(message: ccsds.Message) -> dict[str, dict[str, tuple[float, int]]]:
    """Return the values [rad, m] and lines of a segment's data, by time and type.

    Raises InputError for a time without all types.
    """
    message.expect("DATA_START")
    if message.peek() == "DATA_STOP":
        raise message.error("a measurement", message.peek())
    data: dict[str, dict[str, tuple[float, int]]] = {}
    while message.peek() != "DATA_STOP":
        number, kind, text = message.pair()
        time, *values = text.split()
        if _PASSED_OVER.fullmatch(kind):
            continue
        if kind not in _TYPES or len(values) != 1:
            raise message.error(f"{' or '.join(_TYPES)} = time value", f"{kind} = {text}", number)
        measured = data.setdefault(time, {})
        if kind in measured:
            raise message.error(f"{kind} once at a time", f"{kind} = {text}", number)
        measured[kind] = _value(message, kind, values[0], number), number
    message.take()
    for time, measured in data.items():
        if missing := [kind for kind in _TYPES if kind not in measured]:
            raise message.error(f"{missing[0]} at {time}", "none", next(iter(measured.values()))[1])
    return data


def _check_alike(table: pd.DataFrame) -> None:
    """Raise InputError where the RSO or the time system changes."""
    for column, what in (("rso", "tracks of"), ("scale", "time system")):
        values = table[column].str.upper()
        other = (values != values.iloc[0]).to_numpy()
        if other.any():
            first, row = table.iloc[0], table.iloc[int(other.argmax())]
            expected = f"{what} {first[column]}, as in {first['path']}"
            raise InputError(f"{row['path']}: line {row['line']}: expected {expected}, got {row[column]}")
