"""The ephemerides of all models from one morning, which later mornings judge one after the other."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from opml.ephemerides.replays import arrivals

_ALONG = "e_y_"
"""How the columns of corrections begin; the name of the model follows."""


@dataclass(frozen=True)
class Paths:
    """The ephemerides of a morning; table: `paths`."""

    table: pd.DataFrame

    @property
    def made_at(self) -> float:
        """When they were made [s]."""
        return float(self.table["morning"].iloc[0])

    @property
    def models(self) -> list[str]:
        """The names of their models."""
        return [name.removeprefix(_ALONG) for name in self.table if name.startswith(_ALONG)]

    @cached_property
    def arrivals(self) -> Callable[[np.ndarray], np.ndarray]:
        """Where the prediction is at times [s], and each model's, as `replays.arrivals`; made once."""
        corrections = self.table[[f"{_ALONG}{model}" for model in self.models]].to_numpy().T
        return arrivals(self.table, corrections)
