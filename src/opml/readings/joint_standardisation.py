"""A reading of the paper: variables are standardised over the training rows and the test rows together.

The paper takes 'the mean and standard deviation of each variable', but does not name the rows. To take those
of the test is a mistake of method: the model then depends on rows that no catalogue has when it trains. Each
test has a model of its own, which corrects row by row like any other.
"""

from dataclasses import replace

import pandas as pd

from opml.base.errors import InputError
from opml.learning.models import learners
from opml.learning.models.contract import Model, ResolvedSettings
from opml.learning.models.inputs import Training, check_rows, columns_of
from opml.readings.own_standardisation import Standardising


def train_jointly(
    rows: pd.DataFrame, tested: pd.DataFrame, *, component: str, settings: ResolvedSettings, seed: int
) -> Model:
    """Train a learner on rows of a dataset, with variables standardised over these and the rows tested.

    settings: as `learners.resolved` returns them

    All rows weigh the same in the standardisation. Raises InputError as `learners.train` does, and for a
    learner that does not standardise.
    """
    variables = settings.variables
    beside = check_rows(columns_of(tested, variables), variables)
    training = Training.from_rows(rows, variables, component=component, seed=seed)
    model = learners.fit(replace(training, standardised_with=beside), settings)
    if not isinstance(model, Standardising):
        raise InputError("test split: -together: expected a learner that standardises its variables")
    return model
