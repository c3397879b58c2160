"""Writer of ephemerides as CCSDS orbit comprehensive messages (OCM 3.0, KVN), as traffic services take them.

Source: CCSDS 502.0-B-3, section 6. A message is of one object and holds a trajectory, and covariances in RSW
where they are known.
"""

from collections.abc import Iterator

import numpy as np

from opml import __version__
from opml.base.files import FilePath
from opml.interop import ccsds
from opml.interop.oem import Segment

_KILO = 3
_FRAMES = {"GCRF": "GCRF", "RSW": "RSW_INERTIAL"}
"""Names of the frames of covariances in the registry of orbit-relative frames: velocities are inertial."""


def write(path: FilePath, segment: Segment, *, epoch: str, comment: str = "") -> None:
    """Write a segment, whole or not at all."""
    ccsds.write(path, _lines(segment, epoch, comment))


def _lines(segment: Segment, epoch: str, comment: str) -> Iterator[str]:
    times = ccsds.utc_texts(epoch, segment.t)
    (zero,) = ccsds.utc_texts(epoch, np.zeros(1))
    yield "CCSDS_OCM_VERS = 3.0"
    yield "COMMENT The creation date is that of the newest input."
    yield from [f"COMMENT {comment}"] if comment else []
    yield f"CREATION_DATE = {ccsds.creation_date(epoch, segment.newest)}"
    yield f"ORIGINATOR = OPML {__version__}"
    yield ""
    yield "META_START"
    yield f"OBJECT_NAME = {segment.name}"
    identity = segment.identity
    yield from [f"INTERNATIONAL_DESIGNATOR = {identity.designator}"] if identity.designator else []
    yield from ["CATALOG_NAME = SATCAT", f"OBJECT_DESIGNATOR = {identity.number}"] if identity.number else []
    yield "TIME_SYSTEM = UTC"
    yield f"EPOCH_TZERO = {zero}"
    yield f"START_TIME = {times[0]}"
    yield f"STOP_TIME = {times[-1]}"
    yield "META_STOP"
    yield ""
    yield "TRAJ_START"
    yield from [f"COMMENT {segment.remark}"] if segment.remark else []
    yield "TRAJ_BASIS = PREDICTED"
    yield from (
        ["INTERPOLATION = HERMITE", f"INTERPOLATION_DEGREE = {segment.degree}"] if segment.degree else []
    )
    yield "CENTER_NAME = EARTH"
    yield "TRAJ_REF_FRAME = GCRF"
    yield "TRAJ_TYPE = CARTPV"
    yield "TRAJ_UNITS = [km,km,km,km/s,km/s,km/s]"
    yield from ccsds.lines(times, segment.states, -_KILO)
    yield "TRAJ_STOP"
    if len(segment.covariances):
        yield ""
        yield from _covariance_lines(segment, epoch)


def _covariance_lines(segment: Segment, epoch: str) -> Iterator[str]:
    yield "COV_START"
    yield f"COV_REF_FRAME = {_FRAMES[segment.covariance_frame]}"
    yield "COV_TYPE = CARTPV"
    yield "COV_ORDERING = LTM"
    yield "COV_UNITS = [km,km,km,km/s,km/s,km/s]"
    times = ccsds.utc_texts(epoch, segment.covariance_t)
    yield from ccsds.lines(times, segment.covariances[:, *np.tril_indices(6)], -2 * _KILO)
    yield "COV_STOP"
