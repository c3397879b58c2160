"""A model's correction of chosen rows of a dataset."""

import numpy as np
import pandas as pd

from opml.learning.contract import Model, Predictor
from opml.learning.inputs import columns_of
from opml.learning.zscore import Rescaled
from opml.naming import parse_test


def as_tested(model: Model, test: str) -> Predictor:
    """The model as the name of a test has it meet rows: as they are, or standardised by themselves.

    A test that is standardised together with the training has a model of its own, which meets rows as they
    are. Raises InputError for a name that is none, or a model that does not standardise.
    """
    return Rescaled.around(model) if parse_test(test).standardisation == "own" else model


def evaluate(model: Predictor, dataset: pd.DataFrame, rows: np.ndarray, *, component: str) -> pd.DataFrame:
    """The `evaluation` table: true, predicted and residual error of `component` on the rows (bool mask).

    The residual is true minus predicted, what the ML-modified prediction is still wrong by. Raises InputError
    for a dataset without a variable of the model.
    """
    chosen = dataset.loc[rows]
    true = chosen[component].to_numpy()
    predicted = model.predict(columns_of(chosen, model.variables))
    return pd.DataFrame(
        {
            "i": chosen["i"].to_numpy(),
            "j": chosen["j"].to_numpy(),
            "duration": chosen["duration"].to_numpy(),
            "true": true,
            "predicted": predicted,
            "residual": true - predicted,
        }
    )
