"""A model's correction of chosen rows of a dataset."""

import numpy as np
import pandas as pd

from opml.learning.models.contract import Predictor
from opml.learning.models.inputs import columns_of


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
