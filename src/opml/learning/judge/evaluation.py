"""The correction of rows of a dataset by a model."""

import numpy as np
import pandas as pd

from opml.learning.models.contract import Model
from opml.learning.models.training_inputs import columns_of


def evaluate(model: Model, dataset: pd.DataFrame, rows: np.ndarray, *, component: str) -> pd.DataFrame:
    """Return the `evaluation` table: true, predicted and residual error of a component.

    rows: (bool, n) which rows of the dataset

    The residual is true minus predicted: the error of the corrected prediction. Raises InputError for a
    dataset without a variable of the model.
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
