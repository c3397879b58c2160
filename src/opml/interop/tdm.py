"""Tracks as CCSDS tracking data messages (TDM 2.0, KVN), out and in.

A segment holds what one station measured of one track: azimuth, elevation and range. Measurements are
geometric, so the path runs from the RSO to the station and the range is the distance at the time tag.
Source: CCSDS 503.0-B-2.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from opml.elements import wrap_turn
from opml.files import FilePath
from opml.interop import ccsds

_KEY = "CCSDS_TDM_VERS"
_VERSIONS = ("1.0", "2.0")
_KILO = 3  # kilometres in the message, metres here
_TYPES = ("ANGLE_1", "ANGLE_2", "RANGE")
COLUMNS = ["track", "t", "station", "azimuth", "elevation", "range"]
"""Columns of the `tracking` table that a message carries; it knows nothing of noise-free values."""


def write(path: FilePath, tracking: pd.DataFrame, *, epoch: str, rso: str) -> None:
    """Write the measurements of a `tracking` table as a TDM, whole or not at all; `epoch` is UTC text."""
    ccsds.write(path, _lines(tracking, epoch, rso))


def read(path: FilePath, *, epoch: str) -> pd.DataFrame:
    """Read the measurements of a TDM: `COLUMNS`, with times from the UTC text `epoch`, by time.

    Tracks are numbered from 0 by time. A track is the segments of one TRACK_ID, or a segment without one.
    Raises InputError, naming file and line, for what is malformed, an epoch without all three measurements,
    and other types, units or paths.
    """
    message = ccsds.Message(path, version_key=_KEY, versions=_VERSIONS)
    message.skip_header()
    parts: list[pd.DataFrame] = []
    while message.peek() or not parts:
        parts.append(_segment(message, epoch, default=f"segment {len(parts)}"))
    table = pd.concat(parts).sort_values("t", kind="stable", ignore_index=True)
    table["track"] = pd.factorize(table["track"])[0]
    return table[COLUMNS]


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
        angles = np.degrees(rows[["azimuth", "elevation"]].to_numpy()).tolist()
        for time, (azimuth, elevation), distance in zip(times, angles, rows["range"], strict=True):
            yield f"ANGLE_1 = {time} {ccsds.number_text(azimuth, 0)}"
            yield f"ANGLE_2 = {time} {ccsds.number_text(elevation, 0)}"
            yield f"RANGE = {time} {ccsds.number_text(distance, -_KILO)}"
        yield "DATA_STOP"


def _segment(message: ccsds.Message, epoch: str, *, default: str) -> pd.DataFrame:
    """The measurements of a segment; its track is `default` where it names none."""
    message.expect("META_START")
    metadata = message.pairs("META_STOP")
    metadata.one_of("PATH", ("2,1",))
    metadata.one_of("ANGLE_TYPE", ("AZEL",))
    metadata.one_of("RANGE_UNITS", ("KM",), default="km")
    scale = metadata.one_of("TIME_SYSTEM", ccsds.SCALES)
    data = _data(message)
    lines = [next(iter(measured.values()))[1] for measured in data.values()]
    values = np.array([[measured[kind][0] for kind in _TYPES] for measured in data.values()])
    return pd.DataFrame(
        {
            "track": metadata.text("TRACK_ID", default),
            "t": message.elapsed(list(data), lines, epoch=epoch, scale=scale),
            "station": metadata.text("PARTICIPANT_1"),
            "azimuth": wrap_turn(np.radians(values[:, 0])),
            "elevation": np.radians(values[:, 1]),
            "range": values[:, 2],
        }
    )


def _data(message: ccsds.Message) -> dict[str, dict[str, tuple[float, int]]]:
    """Values [deg, m] and their lines of a segment's data, by time and type; every time has all types."""
    message.expect("DATA_START")
    data: dict[str, dict[str, tuple[float, int]]] = {}
    while message.peek() != "DATA_STOP":
        number, kind, text = message.pair()
        time, *values = text.split()
        if kind not in _TYPES or len(values) != 1:
            raise message.wrong(f"{' or '.join(_TYPES)} = time value", f"{kind} = {text}", number)
        measured = data.setdefault(time, {})
        if kind in measured:
            raise message.wrong(f"{kind} once at a time", f"{kind} = {text}", number)
        measured[kind] = message.scaled(values[0], _KILO if kind == "RANGE" else 0, number), number
    if not data:
        raise message.wrong("a measurement", message.peek())
    message.take()
    for time, measured in data.items():
        if missing := [kind for kind in _TYPES if kind not in measured]:
            raise message.wrong(f"{missing[0]} at {time}", "none", next(iter(measured.values()))[1])
    return data
