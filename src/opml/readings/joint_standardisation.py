"""A reading of the paper: variables are standardised over the rows trained on and the rows tested together.

As in `zscore`, 'the mean and standard deviation of each variable' does not say of which rows, and to take
those of the test is a mistake of method: what is learned depends on rows that no catalogue has when it
trains. Every test takes a model of its own. That model corrects row by row, like any other.
"""

from typing import Any

import pandas as pd

from opml.base.errors import InputError
from opml.learning.models import learners
from opml.learning.models.contract import Model, Settings
from opml.learning.models.inputs import STANDARDISED_WITH, checked, columns_of
from opml.readings.own_standardisation import Standardising


def train(
    rows: pd.DataFrame, tested: pd.DataFrame, *, component: str, settings: Settings, seed: int
) -> Model:
    """Train a learner on rows of a dataset, its variables standardised over these and the rows tested.

    Both count row by row. settings: as `learners.resolved` gives them. Raises InputError as `learners.train`
    does, and for a learner that does not standardise.
    """
    variables = settings["variables"]
    own: dict[str, Any] = {STANDARDISED_WITH: checked(columns_of(tested, variables), variables)}
    model = learners.train(rows, component=component, settings={**settings, **own}, seed=seed)
    if not isinstance(model, Standardising):
        raise InputError("test split: -together: expected a learner that standardises its variables")
    return model
