"""The tables of what Earth, Sun and Moon do around a run."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import pandas as pd

from opml.base.constants import GM


@dataclass(frozen=True)
class Environment:
    """Earth, Sun and Moon around a run that starts at `epoch` (UTC text).

    The four tables are those of docs/data.md; gm [m3/s2] and radius [m] are the gravity field's, and gms
    [m3/s2] the bodies', by name. tide_system is the field's, as ICGEM files name it.
    """

    epoch: str
    earth_orientation: pd.DataFrame
    ephemerides: pd.DataFrame
    solar_activity: pd.DataFrame
    gravity_field: pd.DataFrame
    gm: float
    radius: float
    gms: Mapping[str, float] = field(default_factory=lambda: GM)
    tide_system: str = "unknown"
