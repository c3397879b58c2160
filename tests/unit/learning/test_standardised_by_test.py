"""Tests whose rows are standardised by their own mean and deviation."""

from dataclasses import dataclass

import numpy as np
import pytest

from opml.base.errors import InputError
from opml.learning.judge import standardised_by_test
from opml.learning.models import fixed_laws
from opml.learning.models.training_inputs import Training

VARIABLES = ("duration", "inc")


@dataclass(frozen=True, eq=False)
class Linear:
    """2 x_1 + 3 x_2, of rows around (10, 50)."""

    variables = VARIABLES
    x_mean = np.array([10.0, 50.0])
    x_scale = np.array([2.0, 0.1])

    def predict(self, x):
        return x @ [2.0, 3.0]


@pytest.fixture(scope="module")
def model():
    return Linear()


def test_rows_meet_the_model_with_the_mean_and_deviation_of_its_own(model):
    rescaled = standardised_by_test.Rescaled.around(model)
    x = np.random.default_rng(1).normal([100.0, -7.0], [5.0, 30.0], (50, 2))
    z = (x - x.mean(axis=0)) / x.std(axis=0, ddof=1)
    np.testing.assert_allclose(rescaled.predict(x), model.predict(model.x_mean + model.x_scale * z))
    assert rescaled.variables == VARIABLES


def test_where_the_test_lies_does_not_matter_then(model):
    rescaled = standardised_by_test.Rescaled.around(model)
    x = np.random.default_rng(1).normal(size=(50, 2))
    np.testing.assert_allclose(rescaled.predict(1e3 + 20.0 * x), rescaled.predict(x))
    assert abs(model.predict(1e3 + 20.0 * x) - model.predict(x)).min() > 1e3


def test_a_variable_that_never_changes_is_at_the_mean(model):
    x = np.column_stack([np.arange(5.0), np.full(5, 12.0)])
    found = standardised_by_test.Rescaled.around(model).predict(x)
    np.testing.assert_allclose(found.mean(), 2.0 * model.x_mean[0] + 3.0 * model.x_mean[1], rtol=1e-6)


def test_only_the_name_of_a_test_asks_for_it(model):
    assert standardised_by_test.as_tested(model, "days-30-40-unfenced") is model
    assert isinstance(standardised_by_test.as_tested(model, "rest-zscore"), standardised_by_test.Rescaled)
    none = fixed_laws.NONE.fit(Training(np.zeros((2, 0)), np.ones(2), (), seed=1), {})
    with pytest.raises(InputError, match="-zscore: expected a model that standardises"):
        standardised_by_test.as_tested(none, "rest-zscore")
