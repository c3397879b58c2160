"""Small tables of Orekit's numbers under tests/reference, for tests that need no JVM."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from opml.base.constants import BODIES
from validation.case import TABLES
from validation.ours import Environment

if TYPE_CHECKING:
    from validation.orekit import Orekit

AROUND = 6
"""Nodes of the environment's tables that are read for one time."""


def write(name: str, frame: pd.DataFrame, *notes: str) -> None:
    """Write tests/reference/validation_{name}.csv, with notes as comments above the heading."""
    write_noted(f"validation_{name}.csv", frame, *notes)


def write_noted(name: str, frame: pd.DataFrame, *notes: str) -> None:
    """Write a file of tests/reference, with notes as comments above the heading."""
    head = "".join(f"# {note}\n" for note in notes)
    (TABLES / name).write_text(head + frame.to_csv(index=False, lineterminator="\n"), encoding="utf-8")


def read(name: str) -> pd.DataFrame:
    """Table tests/reference/validation_{name}.csv."""
    return pd.read_csv(TABLES / f"validation_{name}.csv", comment="#")


def gravity(orekit: "Orekit", degree: int) -> pd.DataFrame:
    """Return Orekit's coefficients (n, m, c, s), fully normalised, frozen at the epoch."""
    field = orekit.field(degree, degree).onDate(orekit.epoch)
    n, m = np.tril_indices(degree + 1)
    return pd.DataFrame(
        {
            "n": n,
            "m": m,
            "c": [field.getNormalizedCnm(int(i), int(j)) for i, j in zip(n, m, strict=True)],
            "s": [field.getNormalizedSnm(int(i), int(j)) for i, j in zip(n, m, strict=True)],
        }
    )


def nodes(environment: Environment, t: np.ndarray) -> pd.DataFrame:
    """Return the nodes of third bodies and solar activity between which the kernels look up times t [s]."""
    tables = environment.tables
    every = tables["ephemerides"].merge(tables["solar_activity"], on="t", validate="one_to_one")
    at = np.searchsorted(every["t"], t, side="right") - 1
    around = at[:, None] + np.arange(AROUND) - (AROUND // 2 - 1)
    return every.iloc[np.unique(around)]


def bodies(gms: Mapping[str, float]) -> pd.DataFrame:
    """Return the gravitational parameters [m3/s2] of the third bodies."""
    return pd.DataFrame({"body": BODIES, "gm": [gms[name] for name in BODIES]})
