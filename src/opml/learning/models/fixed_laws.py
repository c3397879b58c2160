"""What a well-run catalogue does without learning: longer fits, Cd held by its past, its running mean.

Each is a law without a number of its own, in columns of the `arcs` table; P_ML then says what the catalogue
itself would leave of the errors of its short fits.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.setting_types import Positive
from opml.learning.models.contract import Fit, Learner, Metadata, Model, Settings, fixed, table_of
from opml.learning.models.inputs import checked


@dataclass(frozen=True, eq=False)
class CatalogueLaw:
    """The first variable is the error; of four, the second times the third less the fourth is added to it."""

    kind: str
    variables: tuple[str, ...]

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Predicted error (n,) in its own unit; raises InputError as `checked` does."""
        x = checked(x, self.variables)
        if len(self.variables) == 1:
            return x[:, 0].copy()
        difference, answer, cd, past = x.T
        predicted: np.ndarray = difference + answer * (cd - past)
        return predicted

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """An empty table, and metadata of JSON-able values."""
        return pd.DataFrame(), {"kind": self.kind, "variables": list(self.variables)}

    @classmethod
    def from_table(cls, table: pd.DataFrame, metadata: Metadata) -> Self:
        """The law that `to_table` wrote."""
        return cls(metadata["kind"], tuple(metadata["variables"]))


def _fit_of(kind: str) -> Fit:
    def fit(
        x: np.ndarray,
        y: np.ndarray,
        *,
        variables: Sequence[str],
        settings: Settings,
        seed: int,
        groups: np.ndarray | None = None,
        weights: np.ndarray | None = None,
    ) -> Model:
        """Nothing to train."""
        checked(x, variables)
        return CatalogueLaw(kind, tuple(variables))

    return fit


def _law(kind: str, description: str, settings: Sequence[str], *variables: str) -> Learner:
    return Learner(
        kind=kind,
        description=description,
        settings=dict.fromkeys(settings, Positive),
        table=table_of("nothing: there is no number to keep"),
        fit=_fit_of(kind),
        load=CatalogueLaw.from_table,
        resolve=fixed(*variables),
        learns=False,
    )


REFITTED = _law("refitted", "fit over another window, nothing learned", ["window_hours"], "l_arc")

HELD = _law(
    "held",
    "Cd held by its own past: a-priori mean and variance from earlier estimates",
    ["window_hours", "memory_days"],
    "h_arc",
)

RUNNING = _law(
    "running",
    "law without a truth: l_arc + v_arc (cd_arc - cd_past), with the running mean of Cd",
    ["window_hours", "memory_days"],
    *("l_arc", "v_arc", "cd_arc", "cd_past"),
)

THERMOMETER = _law(
    "thermometer",
    "fit over another window, with Cd as the fits of many RSOs together have it",
    [],
    "thermo",
)
"""Its window and memory are those of the run's `thermometer`, as all RSOs share it."""
