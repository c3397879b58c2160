"""What a catalogue knows of an RSO: the tables at its tracks, and how more is made of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.catalog.predict import other_windows
from opml.learning.data import dataset
from opml.learning.data.cleaning import Cleaning
from opml.tables import read_metadata, read_table


@dataclass(frozen=True)
class OtherWindow:
    """Fits of the same tracks over another window: the table `estimates`, the window [h]."""

    estimates: pd.DataFrame
    window_hours: float

    @property
    def window(self) -> float:
        """Length of the window [s]."""
        return HOUR * self.window_hours


@dataclass(frozen=True)
class Known:
    """What a catalogue knows of an RSO.

    estimates: the table, of fits over window_hours
    at_estimates: from `dataset.of_estimates`
    gm: [m3/s2]
    long, arc: fits over other windows; None where the learner asks for nothing of them
    bounds: on Cd, None for any
    resonances: pairs (k, m)
    memory_days: of the arcs' Cd
    manoeuvres: times [s]
    """

    estimates: pd.DataFrame
    at_estimates: pd.DataFrame
    window_hours: float
    gm: float
    long: OtherWindow | None = None
    arc: OtherWindow | None = None
    bounds: tuple[float, float] | None = None
    resonances: Sequence[tuple[int, int]] = ()
    memory_days: float = 0.0
    manoeuvres: Sequence[float] = ()

    @classmethod
    def read(cls, files: Any, settings: Mapping[str, Any]) -> Self:
        """Read what the tables of a job hold.

        Raises InputError where a table is missing, damaged or does not belong to the others.
        """
        estimates = read_table(files.estimates, "estimates")
        gm, mechanism = read_metadata(files.gravity_field)["gm"], settings["mechanism"]
        at_estimates = dataset.of_estimates(
            estimates,
            read_table(files.predictions, "predictions"),
            read_table(files.tracking, "tracking"),
            gm=gm,
            cleaning=Cleaning.from_settings(settings["cleaning"]),
        )
        arc_hours, memory_days = settings["arc"]
        manoeuvres = read_metadata(files.manoeuvres) if files.manoeuvres else {}
        return cls(
            estimates,
            at_estimates,
            settings["window_hours"],
            gm,
            long=_other_window(files.get("long_estimates"), mechanism["long_window_hours"]),
            arc=_other_window(files.get("arc_estimates"), arc_hours),
            bounds=settings["cd_bounds"],
            resonances=mechanism["resonances"],
            memory_days=memory_days,
            manoeuvres=[manoeuvre["t"] for manoeuvre in manoeuvres.get("manoeuvres", [])],
        )

    @property
    def window(self) -> float:
        """Length of the window of the fits [s]."""
        return HOUR * self.window_hours

    def arc_estimates(self) -> pd.DataFrame:
        """Return the fits of arcs, `other_windows.undisturbed`; raise InputError where there are none."""
        if self.arc is None:
            expected = "expected fits over another window, as the learner asks for"
            raise InputError(f"ephemeris: {expected}, got none")
        return other_windows.undisturbed(
            self.arc.estimates, manoeuvres=self.manoeuvres, window=self.arc.window
        )

    def may_depart(self) -> np.ndarray:
        """Return which estimates (n,) ephemerides may start from."""
        return dataset.may_depart(
            self.estimates, self.at_estimates, manoeuvres=self.manoeuvres, window=self.window
        )


def _other_window(path: str | None, window_hours: float) -> OtherWindow | None:
    """Return the fits of a file, if there is one."""
    return OtherWindow(read_table(path, "estimates"), window_hours) if path else None
