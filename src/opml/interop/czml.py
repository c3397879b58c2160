"""Writer of an orbit as CZML, which Cesium shows over a globe.

Source: Analytical Graphics, CZML Guide (github.com/AnalyticalGraphicsInc/czml-writer/wiki).
"""

import json
from typing import Any

import numpy as np

from opml.base.files import FilePath, write_text
from opml.interop import ccsds

_SECONDS = len("2016-09-28T12:09:45")
_TRAIL = 5400.0  # time before and behind the object over which its path is drawn [s]


def write(path: FilePath, name: str, t: np.ndarray, positions: np.ndarray, *, epoch: str) -> None:
    """Write an orbit as CZML, whole or not at all.

    t: (n,) [s since the UTC text `epoch`]; positions: (n, 3) in GCRF [m]
    """
    begin, end = (f"{text[:_SECONDS]}Z" for text in ccsds.utc_texts(epoch, t[[0, -1]]))
    span = f"{begin}/{end}"
    # Times count in SI seconds, as CZML's do in TAI; millimetres are enough for a drawing.
    samples = np.round(np.column_stack([t - t[0], positions]), 3).ravel().tolist()
    clock = {"interval": span, "currentTime": begin, "multiplier": 60}
    packets: list[dict[str, Any]] = [
        {"id": "document", "name": name, "version": "1.0", "clock": clock},
        {
            "id": name,
            "availability": span,
            "position": {
                "epoch": begin,
                "referenceFrame": "INERTIAL",
                "interpolationAlgorithm": "LAGRANGE",
                "interpolationDegree": 5,
                "cartesian": samples,
            },
            "point": {"pixelSize": 8, "color": {"rgba": [213, 94, 0, 255]}},
            "label": {"text": name, "pixelOffset": {"cartesian2": [12, -12]}},
            "path": {"leadTime": _TRAIL, "trailTime": _TRAIL, "width": 1, "resolution": 60},
        },
    ]
    write_text(path, json.dumps(packets) + "\n")
