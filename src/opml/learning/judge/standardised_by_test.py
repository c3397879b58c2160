"""A reading of the paper: test rows are standardised by their own mean and deviation.

'The learning variables will be standardized using the mean and standard deviation of each variable': the
paper does not name the rows. To standardise a test by itself is a mistake of method. The correction of a row
then depends on all other rows, and the mean over the test leaks into it, which no catalogue knows at t_i.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from opml.base.errors import InputError
from opml.learning.models.contract import Model, Predictor
from opml.learning.models.training_inputs import check_rows, standardisation
from opml.naming import parse_test


@dataclass(frozen=True, eq=False)
class Rescaled:
    """A model applied to rows as if they had the mean and deviation of its training rows."""

    model: Model
    mean: np.ndarray  # (variables,), of the training rows
    scale: np.ndarray  # (variables,), likewise

    @classmethod
    def around(cls, model: Model) -> Self:
        """Return a model rescaled; raise InputError for a model that does not standardise."""
        mean, scale = getattr(model, "x_mean", None), getattr(model, "x_scale", None)
        if mean is None or scale is None:
            raise InputError("test split: -zscore: expected a model that standardises its variables")
        return cls(model, np.asarray(mean), np.asarray(scale))

    @property
    def variables(self) -> tuple[str, ...]:
        """Columns of a dataset that it predicts from."""
        return self.model.variables

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return predicted errors (n,) of rows x (n, variables); each depends on all rows."""
        x = check_rows(x, self.variables)
        mean, scale = standardisation(x)
        return self.model.predict(self.mean + self.scale * (x - mean) / scale)


def as_tested(model: Model, test: str) -> Predictor:
    """Return the model as the name of a test applies it: to rows as they are, or standardised by themselves.

    Raises InputError for an unknown name, or a model that does not standardise.
    """
    return Rescaled.around(model) if parse_test(test).standardisation == "own" else model
