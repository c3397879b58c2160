"""Tables of the Earth's rotation and gravity, the third bodies and the Sun's activity, made once per run.

Throughout, `epoch` is the UTC text from which times t [s], arrays (n,), count; `path` names a file in errors.
"""

import math

import numpy as np

from opml.base import epochs
from opml.base.constants import HOUR

STEP_S = HOUR  # spacing of the nodes of every table of the environment [s]
MARGIN_S = 2.0 * HOUR  # least length of the tables before the epoch and after the end of a run [s]


def nodes(epoch: str, duration_s: float) -> np.ndarray:
    """Return the times (n,) of the tables' nodes [s since `epoch`], uniform and on whole UTC hours.

    They reach from at least MARGIN_S before the epoch to at least MARGIN_S after `duration_s`. A leap second
    inside the run leaves the nodes after it 1 s off the hour. Raises InputError on a malformed epoch.
    """
    *_, minute, second = epochs.parse(epoch)
    past_hour = 60.0 * minute + second
    first = -past_hour - MARGIN_S
    count = math.ceil((duration_s + MARGIN_S - first) / STEP_S) + 1
    return first + STEP_S * np.arange(count)
