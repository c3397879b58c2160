"""Writer and reader of tracks as CCSDS tracking data messages (TDM 1.0 and 2.0, KVN).

The writer makes a segment for each station and track, and another where a station measures angles of both
kinds. The reader takes messages of any software; the station is the participant that receives, the last one
in the path. Range and rate of a path there and back are half of the whole. Source: CCSDS 503.0-B-2.
"""

import logging
import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import count
from typing import Any

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import line_error
from opml.orbits.elements import wrap_turn

_KEY = "CCSDS_TDM_VERS"
_VERSIONS = ("1.0", "2.0")
_KILO = 3  # kilometres in the message, metres here
_ANGLES = {"AZEL": ("azimuth", "elevation"), "RADEC": ("right_ascension", "declination")}
"""Observables of ANGLE_1 and ANGLE_2, by ANGLE_TYPE."""

_DISTANCES = {"RANGE": "range", "DOPPLER_INSTANTANEOUS": "range_rate"}
_TYPES = ("ANGLE_1", "ANGLE_2", *_DISTANCES)
_TOGETHER = ("ANGLE_1", "ANGLE_2", "RANGE")  # types that a segment has at each of its times, or at none

_PATHS = ("2,1", "1,2", "1,2,1", "2,1,2")
"""Paths for reading: from the other participant to the receiver, or there and back."""

_FRAMES = {name.upper(): rotation for name, rotation in ccsds.FRAMES.items()}
_WRITTEN_FRAME = "ICRF"

_PASSED_OVER = re.compile(
    r"CARRIER_POWER|DOPPLER_(INTEGRATED|COUNT)|DOR|MAG|P[CR]_N0|PRESSURE|RCS"
    r"|(RECEIVE|TRANSMIT)_(FREQ|FREQ_RATE|PHASE_CT)(_\d)?|RHUMIDITY|STEC|TEMPERATURE|TROPO_(DRY|WET)"
    r"|VLBI_DELAY"
)
"""Types of data that the estimation does not use."""

_CLOCKS = ("CLOCK_BIAS", "CLOCK_DRIFT")

_DELAYS = (*(f"{end}_DELAY_{k}" for end in ("TRANSMIT", "RECEIVE") for k in range(1, 6)), "RANGE_MODULUS")
_ABERRATIONS = ("CORRECTION_ABERRATION_YEARLY", "CORRECTION_ABERRATION_DIURNAL")
_DEGRADED = "DEGRADED"
_QUALITIES = ("RAW", "VALIDATED", _DEGRADED)
_log = logging.getLogger(__name__)

COLUMNS = ["track", "t", "station", "azimuth", "elevation", "range"]
"""Columns of the table `tracking` in a message, which has no noise-free values."""


def write(path: FilePath, tracking: pd.DataFrame, *, epoch: str, rso: str) -> None:
    """Write the measurements of a table `tracking` as a TDM, whole or not at all."""
    ccsds.write(path, _lines(tracking, epoch, rso))


def measurements(paths: Sequence[FilePath], *, epoch: str, wanted: str | None = None) -> pd.DataFrame:
    """Read the measurements of TDMs of one RSO, in the order of the files.

    wanted: its name, designator or number; None: the files have only one

    Columns: t [s since `epoch`]; azimuth, elevation [rad]; range [m]; range_rate [m/s], right_ascension,
    declination [rad] and two_way, whether there and back, where the files have any; station and
    rso, the names in the file; scale, the time system; track_id, empty without TRACK_ID; segment, numbered
    through all files; path and line. What is not measured is NaN.

    Raises InputError, naming file and line, for a malformed message, a time that lacks an angle or range
    that others have, other units and paths, delays, times of sending, aberration not corrected, and an RSO or
    time system that differs from the first. Segments of degraded data are left out, and logged.
    """
    segments: list[pd.DataFrame] = []
    numbers = count()
    for path in paths:
        message = ccsds.Message(path, version_key=_KEY, versions=_VERSIONS)
        segments += [_segment(message, epoch, next(numbers)) for _ in message.segments()]
    table = pd.concat(segments, ignore_index=True)
    if table.empty:
        raise InputError(f"{paths[0]}: expected angles, ranges or their rates, got none")
    if wanted is not None:
        table = _of_object(table, wanted)
    for column, what in (("rso", "tracks of"), ("scale", "time system")):
        values = table[column].str.upper()
        other = (values != values.iloc[0]).to_numpy()
        if other.any():
            first, row = table.iloc[0], table.iloc[int(other.argmax())]
            expected = f"{what} {first[column]}, as in {first['path']}"
            raise InputError(f"{row['path']}: line {row['line']}: expected {expected}, got {row[column]}")
    for name in COLUMNS[3:]:
        table[name] = table.get(name, np.nan)
    table["two_way"] = table["two_way"].astype(bool)
    return table if table["two_way"].any() else table.drop(columns="two_way")


def _of_object(table: pd.DataFrame, wanted: str) -> pd.DataFrame:
    """Return the measurements of one object. Raises InputError where there are none."""
    called = {name: ObjectId.of_word(name) for name in table["rso"].unique()}
    ours = table["rso"].isin([name for name, one in called.items() if one.is_called(wanted)])
    if not ours.any():
        got = ", ".join(one.identifier or str(one) for one in called.values())
        path = table["path"].iloc[0]
        raise InputError(f"{path}: expected tracks of {wanted}, got those of {got}")
    return table[ours].reset_index(drop=True)


def identity(measurements: pd.DataFrame) -> ObjectId:
    """Return what the participant that was measured shows about the object, by `measurements`."""
    return ObjectId.of_word(str(measurements["rso"].iloc[0]))


def _lines(tracking: pd.DataFrame, epoch: str, rso: str) -> Iterator[str]:
    yield from ccsds.header(_KEY, epoch, float(tracking["t"].max()))
    there_and_back = tracking["two_way"] if "two_way" in tracking else pd.Series(False, tracking.index)
    for (track, station, two_way), rows in tracking.groupby(["track", "station", there_and_back], sort=False):
        around = {"TRACK_ID": track, "PARTICIPANT_1": station, "PARTICIPANT_2": rso}
        around["PATH"] = "1,2,1" if two_way else "2,1"
        distances = {kind: name for kind, name in _DISTANCES.items() if _has(rows, name)}
        angles = [kind for kind, names in _ANGLES.items() if any(_has(rows, name) for name in names)]
        for kind in angles or [""]:
            names = dict(zip(_TYPES, _ANGLES.get(kind, ()), strict=False)) | distances
            yield from _segment_lines(rows, names, epoch, {**around, **_units(kind, names)})
            distances = {}


def _units(angle_type: str, names: Collection[str]) -> dict[str, str]:
    """Return the metadata of angles, of a type or '' without them, and of other types of data."""
    units = {"RANGE_UNITS": "km"} if "RANGE" in names else {}
    units |= {"ANGLE_TYPE": angle_type} if angle_type else {}
    return units | ({"REFERENCE_FRAME": _WRITTEN_FRAME} if angle_type == "RADEC" else {})


def _segment_lines(
    rows: pd.DataFrame, names: Mapping[str, str], epoch: str, metadata: Mapping[str, Any]
) -> Iterator[str]:
    times = ccsds.utc_texts(epoch, rows["t"].to_numpy())
    pairs = {
        "TRACK_ID": metadata["TRACK_ID"],
        "DATA_TYPES": ",".join(names),
        "TIME_SYSTEM": "UTC",
        "START_TIME": times[0],
        "STOP_TIME": times[-1],
        "PARTICIPANT_1": metadata["PARTICIPANT_1"],
        "PARTICIPANT_2": metadata["PARTICIPANT_2"],
        "MODE": "SEQUENTIAL",
        **metadata,
    }
    yield from ["", "META_START"]
    yield "COMMENT geometric measurements: no light time, no aberration, no refraction"
    yield from (f"{key} = {value}" for key, value in pairs.items())
    yield from ["META_STOP", "DATA_START"]
    for time, values in zip(times, rows[list(names.values())].to_numpy().tolist(), strict=True):
        for kind, value in zip(names, values, strict=True):
            if not math.isnan(value):
                is_length = kind in _DISTANCES
                text = ccsds.number_text(value, -_KILO) if is_length else ccsds.degrees_text(value)
                yield f"{kind} = {time} {text}"
    yield "DATA_STOP"


def _has(rows: pd.DataFrame, name: str) -> bool:
    return name in rows and bool(rows[name].notna().any())


def _segment(message: ccsds.Message, epoch: str, number: int) -> pd.DataFrame:
    """Return the measurements of a segment; an empty table where it holds other types of data only."""
    metadata = message.metadata()
    _check_meaning(metadata)
    data = _data(message)
    if not data:
        return pd.DataFrame()
    if metadata.choice("DATA_QUALITY", _QUALITIES, _QUALITIES[0]) == _DEGRADED:
        _log.warning("%s: a segment of degraded data is ignored", message.path)
        return pd.DataFrame()
    kinds = [kind for kind in _TYPES if any(kind in measured for measured in data.values())]
    station, rso = _participants(metadata)
    names = _observables(metadata, kinds)
    scale = metadata.choice("TIME_SYSTEM", ccsds.SCALES)
    lines = [next(iter(measured.values()))[1] for measured in data.values()]
    nothing = np.nan, 0
    values = np.array([[measured.get(kind, nothing)[0] for kind in kinds] for measured in data.values()])
    values += _corrections(metadata, kinds)
    return pd.DataFrame(
        {
            "t": ccsds.times(message.path, lines, list(data), epoch=epoch, scale=scale),
            "station": station,
            "rso": rso,
            "scale": scale,
            **_in_gcrf(metadata, dict(zip(names, values.T, strict=True))),
            "corrected": metadata.text("CORRECTIONS_APPLIED", "") == "YES",
            "two_way": len(metadata.text("PATH").split(",")) > 2,
            "track_id": metadata.text("TRACK_ID", ""),
            "segment": number,
            "path": str(message.path),
            "line": lines,
        }
    )


def _check_meaning(metadata: ccsds.KeyValues) -> None:
    """Raise InputError where times or values of a segment need what is not done here: they would be off."""
    metadata.choice("TIMETAG_REF", ("RECEIVE",), "RECEIVE")
    not_applied = metadata.text("CORRECTIONS_APPLIED", "") != "YES"
    for key in (*_DELAYS, *(_ABERRATIONS if not_applied else ())):
        if metadata.number(key, default="0") != 0.0:
            raise line_error(metadata.path, metadata.line(key), f"{key} = 0", metadata.text(key))


def _observables(metadata: ccsds.KeyValues, kinds: Sequence[str]) -> list[str]:
    """Return what types of data are measurements of. Raises InputError for other angles and units."""
    names = dict(_DISTANCES)
    if any(kind.startswith("ANGLE") for kind in kinds):
        names |= dict(zip(_TYPES, _ANGLES[metadata.choice("ANGLE_TYPE", tuple(_ANGLES))], strict=False))
    if "RANGE" in kinds:
        metadata.choice("RANGE_UNITS", ("KM",), default="km")
    return [names[kind] for kind in kinds]


def _in_gcrf(metadata: ccsds.KeyValues, columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return measurements with angles within a turn, right ascension and declination on the axes of GCRF."""
    if "azimuth" in columns:
        columns["azimuth"] = wrap_turn(columns["azimuth"])
    if not {"right_ascension", "declination"} & columns.keys():
        return columns
    rotation = _FRAMES[metadata.choice("REFERENCE_FRAME", tuple(_FRAMES))]
    if len({"right_ascension", "declination"} & columns.keys()) < 2:
        raise line_error(metadata.path, metadata.line("ANGLE_TYPE"), "ANGLE_1 and ANGLE_2", "one of them")
    right_ascension, declination = columns["right_ascension"], columns["declination"]
    if not np.array_equal(rotation, np.eye(3)):
        level = np.cos(declination)
        sight = [level * np.cos(right_ascension), level * np.sin(right_ascension), np.sin(declination)]
        x, y, z = rotation @ sight
        right_ascension, declination = np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))
    return columns | {"right_ascension": wrap_turn(right_ascension), "declination": declination}


def _participants(metadata: ccsds.KeyValues) -> tuple[str, str]:
    metadata.choice("MODE", ("SEQUENTIAL",), default="SEQUENTIAL")
    receiver = metadata.choice("PATH", _PATHS)[-1]
    other = "2" if receiver == "1" else "1"
    return metadata.text(f"PARTICIPANT_{receiver}"), metadata.text(f"PARTICIPANT_{other}")


def _corrections(metadata: ccsds.KeyValues, kinds: Sequence[str]) -> np.ndarray:
    """Return the corrections that are not applied yet to each type of a segment (kinds,) [rad, m, m/s]."""
    keys = [f"CORRECTION_{kind.removesuffix('_INSTANTANEOUS')}" for kind in kinds]
    texts = [metadata.text(key, "") for key in keys]
    if not any(texts) or metadata.choice("CORRECTIONS_APPLIED", ("YES", "NO")) == "YES":
        return np.zeros(len(kinds))
    rows = zip(kinds, keys, texts, strict=True)
    return np.array(
        [_value(metadata.path, metadata.line(key), kind, text or "0") for kind, key, text in rows]
    )


def _value(path: FilePath, line: int, kind: str, text: str) -> float:
    """Return a measurement [rad, m, m/s] from its text in degrees, kilometres or kilometres per second."""
    if kind in _DISTANCES:
        return ccsds.scaled(path, line, text, _KILO)
    angle = ccsds.radians(path, line, text)
    if abs(angle) > 2.0 * np.pi:
        raise line_error(path, line, "an angle of -360 to 360 deg", text)
    return angle


def _data(message: ccsds.Message) -> dict[str, dict[str, tuple[float, int]]]:
    """Return the values [rad, m, m/s] and lines of a segment's data, by time and type.

    Raises InputError for a time without angle or range where others have it.
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
        if kind in _CLOCKS and len(values) == 1:
            if ccsds.scaled(message.path, number, values[0], 0) != 0.0:
                raise message.error(f"{kind} of 0, as times count as they are", values[0], number)
            continue
        if kind not in _TYPES or len(values) != 1:
            raise message.error(f"{' or '.join(_TYPES)} = time value", f"{kind} = {text}", number)
        measured = data.setdefault(time, {})
        if kind in measured:
            raise message.error(f"{kind} once at a time", f"{kind} = {text}", number)
        measured[kind] = _value(message.path, number, kind, values[0]), number
    message.take()
    usual = [kind for kind in _TOGETHER if any(kind in measured for measured in data.values())]
    for time, measured in data.items():
        missing = [kind for kind in usual if kind not in measured]
        if missing and any(kind in measured for kind in usual):
            raise message.error(f"{missing[0]} at {time}", "none", next(iter(measured.values()))[1])
    return data
