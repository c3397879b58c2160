"""A reading of the paper: rows to test on are standardised by their own mean and deviation.

'The learning variables will be standardized using the mean and standard deviation of each variable' does not
say of which rows. To standardise a test by itself is a mistake of method: one row's correction then depends
on all others, and the mean over the test, which no catalogue knows at t_i, leaks into it.
"""

from dataclasses import dataclass
from typing import Protocol, Self, runtime_checkable

import numpy as np

from opml.base.errors import InputError
from opml.learning.models.contract import Model, Predictor
from opml.learning.models.inputs import checked, standardisation
from opml.naming import parse_test


@runtime_checkable
class Standardising(Protocol):
    """A model that standardises what it is given by the rows that it was trained on."""

    x_mean: np.ndarray  # (variables,)
    x_scale: np.ndarray  # (variables,)


@dataclass(frozen=True, eq=False)
class Rescaled:
    """A model that meets rows as if they had the mean and deviation of those that it was trained on."""

    model: Model
    mean: np.ndarray  # (variables,), of the rows trained on
    scale: np.ndarray  # (variables,)

    @classmethod
    def around(cls, model: Model) -> Self:
        """Raises InputError for a model that does not standardise."""
        if not isinstance(model, Standardising):
            raise InputError("test split: -zscore: expected a model that standardises its variables")
        return cls(model, np.asarray(model.x_mean), np.asarray(model.x_scale))

    @property
    def variables(self) -> tuple[str, ...]:
        """The columns of a dataset that it predicts from."""
        return self.model.variables

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Predicted errors (n,) of rows x (n, variables), of which each depends on all others."""
        x = checked(x, self.variables)
        mean, scale = standardisation(x)
        return self.model.predict(self.mean + self.scale * (x - mean) / scale)


def as_tested(model: Model, test: str) -> Predictor:
    """The model as the name of a test has it meet rows: as they are, or standardised by themselves.

    A test that is standardised together with the training has a model of its own, which meets rows as they
    are. Raises InputError for a name that is none, or a model that does not standardise.
    """
    return Rescaled.around(model) if parse_test(test).standardisation == "own" else model
