"""Writer and reader of conjunction data messages (CDM 1.0, KVN).

Source: CCSDS 508.0-B-1. RTN there is RSW here. The sum of the radii, which the standard has no key for, is in
a comment `HBR`, as in the messages of NASA's CARA.
"""

import logging
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np

from opml import __version__
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions.conjunction import LARGEST_RADIUS, Conjunction, Participant, check_radius, remarks_on
from opml.dynamics.frames import states_to_gcrf
from opml.environment import earth_orientation
from opml.interop import ccsds
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import line_error
from opml.orbits.density_error import DensityError

_log = logging.getLogger(__name__)

_KEY = "CCSDS_CDM_VERS"
_KILO = 3
_AXES = ("R", "T", "N", "RDOT", "TDOT", "NDOT")
_STATE = ("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT")
_UNITS = ("m", "m/s")
_LOWER = [(row, column) for row in range(6) for column in range(row + 1)]
_STATED = {"MISS_DISTANCE": slice(3), "RELATIVE_SPEED": slice(3, 6)}  # what states have to agree with
_ROUGH = 0.01  # of it that they may be off, as they are rounded
_UNIT = re.compile(r"\s*\[([^\]]*)\]$")
_RADIUS = "HBR"
_LENGTH = re.compile(r"(\S+?)\s*(?:\[(\w+)\])?")
_SENSITIVITY = "DCP Sensitivity Vector RTN"
_DENSITY_KEYS = {
    ccsds.DENSITY_COMMENT: ccsds.DENSITY_KEY,
    f"{_SENSITIVITY} Pos": "DCP_SENSITIVITY_VECTOR_POSITION",
    f"{_SENSITIVITY} Vel": "DCP_SENSITIVITY_VECTOR_VELOCITY",
}
"""Keys of CDM 2.0 for the dynamic consider parameter, by the names that comments of CDM 1.0 have."""

_TERRESTRIAL = "ITRF"
_NODES = 3600.0 * np.arange(-6, 7)  # about a time, for the Earth's orientation then [s]
_LONGEST = 60  # letters of a name in that of a file
_OF_POSITION = 6  # values of the lower triangle that are of the position
_METRES = {None: 1.0, "m": 1.0, "km": 1e3}


def _covariance_key(row: int, column: int) -> str:
    return f"C{_AXES[row]}_{_AXES[column]}"


_UNITS_OF = {key: "km/s" if key.endswith("_DOT") else "km" for key in _STATE} | {
    _covariance_key(row, column): ("m**2", "m**2/s", "m**2/s**2")[(row > 2) + (column > 2)]
    for row, column in _LOWER
}
_RELATIVE = tuple(f"RELATIVE_POSITION_{axis}" for axis in _AXES[:3])
_UNITS_OF |= dict(zip(_STATED, _UNITS, strict=True)) | dict.fromkeys(_RELATIVE, "m")
"""Units of what is read, by key; a message may leave them out."""


def write(path: FilePath, conjunction: Conjunction, *, epoch: str) -> None:
    """Write a conjunction, whole or not at all.

    epoch: UTC text from which its time counts

    Raises InputError where the covariance of either object is unknown: a message needs both.
    """
    ccsds.write(path, _lines(conjunction, epoch))


def write_all(folder: FilePath, conjunctions: Iterable[Conjunction], *, epoch: str) -> None:
    """Write a message of each conjunction, named by objects and time; those without covariances are counted.

    A message has to have the covariances of both objects.
    """
    bare = 0
    for conjunction in conjunctions:
        if conjunction.first.covariance is None or conjunction.second.covariance is None:
            bare += 1
        else:
            write(Path(folder) / f"{_name(conjunction, epoch)}.cdm", conjunction, epoch=epoch)
    if bare:
        _log.warning("conjunctions without a message, as it needs both covariances: %d", bare)


def _name(conjunction: Conjunction, epoch: str) -> str:
    (tca,) = ccsds.utc_texts(epoch, np.array([conjunction.t]))
    names = (one.identity.name[:_LONGEST] for one in (conjunction.first, conjunction.second))
    return re.sub(r"[^\w.+-]", "-", "_".join([*names, re.sub("[-:.]", "", tca)])).lstrip(".")


def _lines(conjunction: Conjunction, epoch: str) -> Iterator[str]:
    (tca,) = ccsds.utc_texts(epoch, np.array([conjunction.t]))
    relative, chance = conjunction.relative, conjunction.chance
    first, second = conjunction.first, conjunction.second
    yield f"{_KEY} = 1.0"
    known = conjunction.t if conjunction.known is None else conjunction.known
    yield f"CREATION_DATE = {ccsds.creation_date(epoch, known)}"
    yield f"ORIGINATOR = OPML {__version__}"
    yield f"MESSAGE_ID = {_name(conjunction, epoch)}"
    yield f"TCA = {tca}"
    yield f"MISS_DISTANCE = {float(np.linalg.norm(relative[:3]))!r} [m]"
    yield f"RELATIVE_SPEED = {float(np.linalg.norm(relative[3:]))!r} [m/s]"
    for k, value in enumerate(relative.tolist()):
        kind = ("POSITION", "VELOCITY")[k // 3]
        yield f"RELATIVE_{kind}_{_AXES[k % 3]} = {value!r} [{_UNITS[k // 3]}]"
    if chance is not None:
        yield f"COLLISION_PROBABILITY = {chance.probability!r}"
        # The standard's registry has no names for Hall's methods.
        if conjunction.method == "2D-Pc":
            yield "COLLISION_PROBABILITY_METHOD = FOSTER-1992"
        yield f"COMMENT PROBABILITY METHOD = {conjunction.method}"
    if (correlated := conjunction.correlated) and correlated.chance:
        yield f"COMMENT PROBABILITY WITH A COMMON DENSITY ERROR = {correlated.chance.probability!r}"
    yield f"COMMENT HBR = {conjunction.radius!r}"
    for number, participant in enumerate((first, second), start=1):
        yield from _participant_lines(participant, number)


def _participant_lines(participant: Participant, number: int) -> Iterator[str]:
    identity = participant.identity
    if participant.covariance is None:
        raise InputError(f"{identity}: expected a covariance, as a CDM has to have, got none")
    yield f"OBJECT = OBJECT{number}"
    yield f"OBJECT_DESIGNATOR = {identity.number or identity.designator or identity.name}"
    yield f"CATALOG_NAME = {'SATCAT' if identity.number else 'NONE'}"
    yield f"OBJECT_NAME = {identity.name}"
    yield f"INTERNATIONAL_DESIGNATOR = {identity.designator or 'UNKNOWN'}"
    yield "EPHEMERIS_NAME = NONE"
    yield "COVARIANCE_METHOD = CALCULATED"
    yield "MANEUVERABLE = N/A"
    yield "REF_FRAME = GCRF"
    if participant.density is not None:
        yield from _density_lines(participant.density)
    for key, value in zip(_STATE, participant.state, strict=True):
        yield f"{key} = {ccsds.number_text(value, -_KILO)} [{_UNITS_OF[key]}]"
    for row, column in _LOWER:
        key = _covariance_key(row, column)
        yield f"{key} = {float(participant.covariance[row, column])!r} [{_UNITS_OF[key]}]"


def _density_lines(density: DensityError) -> Iterator[str]:
    """Yield the comments of the dynamic consider parameter."""
    yield f"COMMENT {ccsds.DENSITY_COMMENT} = {density.uncertainty!r}"
    for kind, part, unit in zip(
        ("Pos", "Vel"), np.split(density.sensitivity, 2), ("m", "m/sec"), strict=True
    ):
        yield f"COMMENT {_SENSITIVITY} {kind} = {' '.join(map(repr, part.tolist()))} [{unit}]"


def read(path: FilePath, *, epoch: str, radius: float | None = None) -> list[Conjunction]:
    """Read the conjunctions of the messages that a file has in a row, in KVN or XML.

    epoch: UTC text from which times count
    radius: sum of the radii [m]; None: that of the comment HBR

    States are turned from the frames of `ccsds.FRAMES`, and from the ITRF, to GCRF. A covariance of positions
    alone, or whose other parts are none, counts as one of positions. Raises InputError, naming file and line,
    for a malformed message, another frame, a radius that neither has, and one that is none.
    """
    names = _DENSITY_KEYS | {_RADIUS: _RADIUS}
    message = ccsds.Message(path, version_key=_KEY, versions=("1.0",), in_comments=names)
    return [_conjunction(one, epoch, radius) for one in message.each()]


def _conjunction(message: ccsds.Message, epoch: str, radius: float | None) -> Conjunction:
    """Return the conjunction of the next message."""
    radii: set[str] = set()
    head, *parts = _blocks(message, radii)
    if (objects := [part.text("OBJECT") for part in parts]) != ["OBJECT1", "OBJECT2"]:
        got = " and ".join(objects) or "none"
        raise InputError(f"{message.path}: expected OBJECT1 and OBJECT2, got {got}")
    t = head.time("TCA", np.nan, epoch=epoch, scale="UTC")
    if not np.isfinite(t):
        raise InputError(f"{message.path}: expected TCA before the objects, got none")
    first, second = (_participant(block, epoch, t) for block in parts)
    for key, part in _STATED.items():
        _check_stated(head, key, float(np.linalg.norm((second.state - first.state)[part])))
    radius = _radius(message.path, radii) if radius is None else radius
    check_radius(radius)
    known = head.time("CREATION_DATE", t, epoch=epoch, scale="UTC")
    stated = None
    with suppress(ValueError):  # it is not needed, and some messages have N/A
        stated = float(head.text("COLLISION_PROBABILITY", ""))
    read = Conjunction(t, first, second, radius, known=known, stated=stated)
    _tell_of_relative(head, read.relative[:3])
    return read


def _tell_of_relative(head: ccsds.KeyValues, relative: np.ndarray) -> None:
    """Log a relative position in RTN that is not that of the states: one of the frames may be another."""
    with suppress(ValueError):  # a message may have none, or N/A
        stated = np.array([float(head.text(key, "")) for key in _RELATIVE])
        apart = min(np.linalg.norm(stated - relative), np.linalg.norm(stated + relative))
        if apart > _ROUGH * np.linalg.norm(stated) + 1.0:
            texts = [" ".join(f"{value:.0f}" for value in vector) for vector in (stated, relative)]
            warning = "%s: RELATIVE_POSITION is %s m, that of the states %s m: is REF_FRAME right?"
            _log.warning(warning, head.path, *texts)


def _check_stated(head: ccsds.KeyValues, key: str, value: float) -> None:
    """Raise InputError where states contradict the distance or speed under a key of the message."""
    stated = head.number(key, default=repr(value))
    if abs(stated - value) > _ROUGH * stated + 1.0:
        expected = f"states of {key} = {stated:g} {_UNITS_OF[key]}"
        raise line_error(head.path, head.line(key), expected, f"{value:g}")


def _blocks(message: ccsds.Message, radii: set[str]) -> list[ccsds.KeyValues]:
    """Return the pairs of the next message before the objects, and those of each object.

    radii: takes what comments have for the sum of the radii, which may be there several times
    """
    blocks = [ccsds.KeyValues(message.path)]
    while not message.is_over:
        number, key, value = message.pair()
        if key == _RADIUS:
            radii.add(value)
            continue
        if key == "OBJECT":
            blocks.append(ccsds.KeyValues(message.path))
        if (unit := _UNIT.search(value)) and unit[1] != _UNITS_OF.get(key, unit[1]):
            raise message.error(f"{key} in [{_UNITS_OF[key]}]", unit[0].strip(), number)
        blocks[-1].add(number, key, _UNIT.sub("", value))
        blocks[-1].last = number
    if not blocks[0].last:
        raise message.error("KEY = value", message.peek())
    return blocks


def _participant(block: ccsds.KeyValues, epoch: str, t: float) -> Participant:
    frame = block.choice("REF_FRAME", (*ccsds.FRAMES, _TERRESTRIAL))
    state = np.array([block.number(key, _KILO) for key in _STATE])
    keys = ("OBJECT_DESIGNATOR", "INTERNATIONAL_DESIGNATOR")
    identity = ObjectId.of(block.text("OBJECT_NAME"), *(block.text(key, "") for key in keys))
    if frame == _TERRESTRIAL:
        state = _from_earth(state, epoch, t)
    else:
        state = np.kron(np.eye(2), ccsds.FRAMES[frame]) @ state
    if not any(block.has(_covariance_key(row, column)) for row, column in _LOWER):
        return Participant(identity, state)
    covariance, left_out = _covariance(block)
    remarks = list(remarks_on(identity.name, covariance))
    if left_out:
        remarks.append(f"covariance of {identity.name} of its position alone: {left_out}")
    density = None if left_out else _density(block)
    if density is not None and not density.is_part_of(covariance):
        density = None
        remarks.append(f"density error of {identity.name} too large")
    return Participant(identity, state, covariance, tuple(remarks), density, bool(left_out))


def _covariance(block: ccsds.KeyValues) -> tuple[np.ndarray, str]:
    """Return the covariance (6, 6) of an object, and why its velocities' parts do not count, '' if they do.

    Positions are all that the miss and a probability in two dimensions need.
    """
    covariance = np.zeros((6, 6))
    whole = all(block.has(_covariance_key(row, column)) for row, column in _LOWER)
    for row, column in _LOWER if whole else _LOWER[:_OF_POSITION]:
        key = _covariance_key(row, column)
        covariance[row, column] = covariance[column, row] = block.number(key)
        if row == column and covariance[row, row] < 0.0:
            raise line_error(block.path, block.line(key), "a variance of 0 or more", block.text(key))
    first = block.line(_covariance_key(0, 0))
    ccsds.check_correlations(block.path, first, covariance[:3, :3])
    if not whole:
        return covariance, "no rows of velocities"
    try:
        ccsds.check_correlations(block.path, first, covariance)
    except InputError:
        covariance[3:] = covariance[:, 3:] = 0.0
        return covariance, "correlations of velocities beyond 1"
    return covariance, ""


def _from_earth(state: np.ndarray, epoch: str, t: float) -> np.ndarray:
    """Return a state (6,) of the ITRF at t [s since the epoch] in GCRF."""
    orientation = earth_orientation.tabulate(epoch, t + _NODES)
    (turned,) = states_to_gcrf(orientation, np.array([t]), *np.split(state[None], 2, axis=1))
    return np.asarray(turned)


def _density(block: ccsds.KeyValues) -> DensityError | None:
    """Return what the forecast density's error does to an object, None where that is not given."""
    uncertainty, *vectors = _DENSITY_KEYS.values()
    if not all(block.has(key) for key in _DENSITY_KEYS.values()):
        return None
    lines = {key: block.line(key) for key in vectors}
    texts = [(lines[key], text) for key in vectors for text in block.text(key).split()]
    numbers = [ccsds.scaled(block.path, line, text, 0) for line, text in texts]
    if len(numbers) != len(_STATE):
        expected = "three numbers in each vector of sensitivity"
        raise line_error(block.path, lines[vectors[0]], expected, f"{len(numbers)} in both")
    return DensityError(block.number(uncertainty), np.array(numbers))


def _radius(path: FilePath, stated: set[str]) -> float:
    """Return the sum of the radii [m] of comments HBR; in metres, where it has no unit."""
    with suppress(ValueError, KeyError, TypeError):
        matches = [_LENGTH.fullmatch(text) for text in stated]
        (radius,) = {float(match[1]) * _METRES[match[2]] for match in matches if match}
        if len(matches) == len(stated) and 0.0 < radius <= LARGEST_RADIUS:
            return radius
    got = " and ".join(sorted(stated)) or "none"
    raise InputError(
        f"{path}: expected a radius up to {LARGEST_RADIUS:g} m in COMMENT HBR, or --radius, got {got}"
    )
