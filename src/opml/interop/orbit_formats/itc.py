"""Reader of operators' ephemerides in the modified ITC format, as SpaceX publishes them for Starlink.

Four lines are a state: its UTC time YYYYDDDhhmmss.sss, position and velocity in EME2000 [km, km/s], and the
lower triangle of the covariance in UVW, which is RSW [km2, km2/s, km2/s2]. The object is in the file's name,
as MEME_44714_STARLINK-1008_2711218_Operational_1379800620_UNCLASSIFIED.txt.
Source: 18th and 19th Space Defense Squadrons, Spaceflight Safety Handbook for Satellite Operators, annex C.
"""

import re
from pathlib import Path

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import Arc, check_ascending, choose_satellites, line_error, numbers, times
from opml.tables import lower_triangles

_HEAD = 4  # lines before the states; the last names the axes of covariances
_LINES, _STATE, _TRIANGLE = 4, 6, 7  # lines of a state, its numbers, and those of a line of its covariance
_AXES = b"UVW"
_TIME = re.compile(rb"(\d{4})(\d{3})(\d\d)(\d\d)(\d\d(?:\.\d*)?)")
_NAMED = re.compile(r"MEME_(\d{1,9})_([^_]+)_")
_KILO = 1e3


def read(path: FilePath, content: bytes, *, epoch: str, satellite: str | None = None) -> list[Arc]:
    """Read the arc of an ephemeris, with a covariance of each state; satellite: as in `choose_satellites`.

    Raises InputError, naming the line, for a malformed or truncated file, and for other axes of covariances.
    """
    rows = [line.split() for line in content.rstrip().splitlines()]
    if len(rows) <= _HEAD or rows[_HEAD - 1] != [_AXES]:
        got = b" ".join(rows[_HEAD - 1]) if len(rows) >= _HEAD else b""
        raise line_error(path, _HEAD, "UVW, the axes of covariances", got)
    widths = [1 + _STATE, *[_TRIANGLE] * (_LINES - 1)]
    for k, row in enumerate(rows[_HEAD:]):
        if len(row) != widths[k % _LINES]:
            expected = f"{widths[k % _LINES]} numbers of a state or its covariance"
            raise line_error(path, _HEAD + 1 + k, expected, b" ".join(row))
    if (len(rows) - _HEAD) % _LINES:
        raise InputError(f"{path}: expected {_LINES - 1} lines of covariance behind each state, got fewer")
    identity = _identity(path)
    choose_satellites(path, [[identity.name, str(identity.number)]], satellite)
    lines = np.arange(_HEAD, len(rows), _LINES)
    states = numbers(path, np.array([rows[k][1:] for k in lines]), lines + 1) * _KILO
    texts = np.array([rows[k + 1] + rows[k + 2] + rows[k + 3] for k in lines])
    t = _times(path, [rows[k][0] for k in lines], lines + 1, epoch)
    return [
        Arc(
            path=path,
            satellite=identity.name,
            frame="EME2000",
            realisation="EME2000",
            scale="UTC",
            t=t,
            positions=states[:, :3],
            velocities=states[:, 3:],
            lines=lines + 1,
            identity=identity,
            covariance_t=t,
            covariances=lower_triangles(numbers(path, texts, lines + 2) * _KILO**2),
            covariance_frame="RSW",
        )
    ]


def _identity(path: FilePath) -> ObjectId:
    name = Path(path).name
    match = _NAMED.match(name)
    return ObjectId.of(match[2], match[1]) if match else ObjectId(name.partition(".")[0])


def _times(path: FilePath, texts: list[bytes], lines: np.ndarray, epoch: str) -> np.ndarray:
    matches = [_TIME.fullmatch(text) for text in texts]
    for match, text, line in zip(matches, texts, lines.tolist(), strict=True):
        if match is None or not 1 <= int(match[2]) <= 366:
            raise line_error(path, line, "a time YYYYDDDhhmmss.sss", text)
    days = [np.datetime64(f"{int(m[1])}-01-01") + (int(m[2]) - 1) for m in matches if m]
    dates = [[int(part) for part in str(day).split("-")] for day in days]
    clocks = [[float(m[k]) for k in (3, 4, 5)] for m in matches if m]
    t = times(path, lines, texts, np.hstack([dates, clocks]), epoch=epoch, scale="UTC")
    check_ascending(path, t, lines)
    return t
