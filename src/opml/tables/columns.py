"""Types for columns and schemas, and names of columns and tables that code asks for."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
import pandas as pd

STATE = ["x", "y", "z", "vx", "vy", "vz"]  # columns of a state; a list, as pandas selects columns by a list
PARAMETERS = [*STATE, "cd"]  # columns of the estimated parameters

BURN = ["burn_t", "burn_x", "burn_y", "burn_z"]
"""Columns of a burn that a track showed: its time, and what it changed in RSW."""

COMPONENTS = tuple(f"e_{axis}" for axis in STATE)  # columns of the components of a prediction error

SPREAD = [f"{cause}_{axis}" for cause in ("drag", "weather") for axis in "xyz"]
"""Columns of the distances by which drag and the weather ahead may move a prediction."""

SIGMAS = [f"sigma_{name}" for name in COMPONENTS]  # columns of a label's uncertainty, by error component

FIX_SIGMAS = [f"sigma_{axis}" for axis in ("r", "s", "w", "vr", "vs", "vw")]
"""Columns of the standard deviations of a point's position and velocity, in RSW."""

DOUBT = [f"doubt_{axis}" for axis in "xyz"]
"""Columns of the standard deviation of the reference state that an ephemeris is compared with."""

SIGMA_STATE = [f"sigma_{name}" for name in STATE]
"""Columns of the standard deviations behind a covariance (`rsw_covariance.rsw_covariances`)."""


IMPROVED_LEADS = (1, 3, 5, 7)  # days from the date to the errors that the table of improved sets expects

MECHANISM_AXES = ("s", "v", "l", "v_long", "l_arc", "v_arc")
"""Prefixes of the mechanism's columns for each error component, such as `v_y` for e_y."""

TRUTH_GROUPS = "truth_groups"  # kind of the tables that list the RSOs whose truths one job made

ENVIRONMENT = ("earth_orientation", "ephemerides", "solar_activity", "gravity_field")
"""Tables from which every force model is made."""

OUTLOOKS = "outlooks"  # table of forecast activity, where the assumed model knows forecasts only


@dataclass(frozen=True)
class Column:
    """A column; its frame is '' where no frame applies."""

    name: str
    dtype: str
    unit: str
    frame: str
    meaning: str


@dataclass(frozen=True)
class Schema:
    """A table: its name, the meaning of a row, and its columns in order."""

    name: str
    row: str
    columns: tuple[Column, ...]
    optional: tuple[Column, ...] = ()  # columns behind these that a table may have

    def among(self, names: Iterable[str]) -> Self:
        """Return the schema of a table with columns of these names, optional ones where it has them."""
        given = set(names)
        present = tuple(column for column in self.optional if column.name in given)
        return replace(self, columns=self.columns + present, optional=())

    def empty(self) -> pd.DataFrame:
        """Return a table without rows."""
        return self._empty.copy()

    @cached_property
    def _empty(self) -> pd.DataFrame:
        dtypes = {column.name: column.dtype.replace("string", "object") for column in self.columns}
        return pd.DataFrame({name: pd.Series(dtype=dtype) for name, dtype in dtypes.items()})

    @property
    def names(self) -> list[str]:
        """Names of the columns in order."""
        return [column.name for column in self.columns]


def real(name: str, unit: str, meaning: str, frame: str = "") -> Column:
    """Return a column of floating point numbers."""
    return Column(name, "float64", unit, frame, meaning)


def count(name: str, meaning: str) -> Column:
    """Return a column of whole numbers."""
    return Column(name, "int64", "1", "", meaning)


def text(name: str, meaning: str) -> Column:
    """Return a column of texts."""
    return Column(name, "string", "", "", meaning)


def flag(name: str, meaning: str) -> Column:
    """Return a column of yes or no."""
    return Column(name, "bool", "", "", meaning)


def unit_of(parameter: str) -> str:
    """Return the unit of an estimated parameter."""
    return "1" if parameter == "cd" else "m/s" if parameter.startswith("v") else "m"


def covariance(parameters: Sequence[str], frame: str) -> tuple[Column, ...]:
    """Return the columns of the covariance of parameters: the lower triangle, row by row."""
    columns = []
    for name, (a, b) in zip(covariance_names(parameters), _lower_triangle(parameters), strict=True):
        units = [unit for unit in (unit_of(a), unit_of(b)) if unit != "1"]
        columns.append(real(name, " ".join(units) or "1", f"covariance of {a} and {b}", frame))
    return tuple(columns)


def covariance_names(parameters: Sequence[str]) -> list[str]:
    """Return the names of the columns of `covariance`."""
    return [f"cov_{a}_{b}" for a, b in _lower_triangle(parameters)]


def _lower_triangle(parameters: Sequence[str]) -> list[tuple[str, str]]:
    return [(a, b) for row, a in enumerate(parameters) for b in parameters[: row + 1]]


STATE_COVARIANCES = covariance_names(STATE)

PARAMETER_COVARIANCES = covariance_names(PARAMETERS)


def state_rows(table: pd.DataFrame) -> np.ndarray:
    """Return the states (n, 6) of a table, row by row in memory."""
    # One column after the other: pandas takes longer to look up a list of them.
    return np.column_stack([table[name].to_numpy() for name in STATE])


def symmetric_matrices(table: pd.DataFrame, columns: Sequence[str]) -> np.ndarray:
    """Return symmetric matrices (n, k, k) from the columns of their lower triangles, row by row."""
    return lower_triangles(table[list(columns)].to_numpy())


def lower_triangles(values: np.ndarray) -> np.ndarray:
    """Return the symmetric matrices (n, k, k) of the numbers (n, k (k + 1) / 2) of their lower triangles."""
    row, column = np.tril_indices(int(np.sqrt(2 * values.shape[1])))
    full = np.empty((len(values), row[-1] + 1, row[-1] + 1))
    full[:, row, column] = full[:, column, row] = values
    return full
