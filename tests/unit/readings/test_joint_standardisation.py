"""Models whose variables are standardised over the rows trained on and the rows tested together."""

import numpy as np
import pandas as pd
import pytest
import sklearn.svm
from support import refusal

import opml
from opml.base.errors import InputError
from opml.learning.models import learners
from opml.readings import joint_standardisation, own_standardisation

VARIABLES = ["duration", "inc"]
SVR = learners.of_job(
    {"kind": "svr", "kernel_scale": 1.5, "c": 1.0, "epsilon": 0.1, "tol": 1e-6, "variables": VARIABLES}
)


def rows(count, seed, *, around):
    """Rows of a dataset, its variables drawn around a place, with an error that bends."""
    x = np.random.default_rng(seed).normal(around, [2.0, 0.1], (count, 2))
    table = pd.DataFrame(x, columns=VARIABLES)
    return table.assign(e_y=np.sin(x[:, 0]) + 5.0 * x[:, 1], i=np.arange(count))


TRAINED, TESTED = rows(120, 0, around=[10.0, 50.0]), rows(60, 1, around=[14.0, 52.0])


def train(settings, tested=TESTED):
    return joint_standardisation.train_jointly(TRAINED, tested, component="e_y", settings=settings, seed=42)


def test_the_deviation_is_that_of_all_rows():
    x = pd.concat([TRAINED, TESTED])[VARIABLES]
    model = train(SVR)
    np.testing.assert_allclose(model.x_scale, x.std(), rtol=1e-12)
    described = model.to_table()[1]
    assert "standardised_with" not in described


def test_the_scales_of_the_variables_are_all_that_changes():
    """Held against another machine, which is given the training's own scores in the deviations of all."""
    model, alone = train(SVR), learners.train(TRAINED, component="e_y", settings=SVR, seed=42)
    ratio = TRAINED[VARIABLES].std() / pd.concat([TRAINED, TESTED])[VARIABLES].std()
    z, z_tested = (
        ratio * (part[VARIABLES] - TRAINED[VARIABLES].mean()) / TRAINED[VARIABLES].std()
        for part in (TRAINED, TESTED)
    )
    machine = sklearn.svm.SVR(C=1.0, epsilon=0.1, gamma=1.5**-2, tol=1e-8)
    machine.fit(z, TRAINED["e_y"] / alone.y_scale)
    expected = alone.y_scale * machine.predict(z_tested)
    x = TESTED[VARIABLES].to_numpy()
    np.testing.assert_allclose(model.predict(x), expected, atol=1e-3)
    assert np.abs(alone.predict(x) - expected).max() > 0.1


def test_a_test_like_the_training_changes_next_to_nothing():
    alone = learners.train(TRAINED, component="e_y", settings=SVR, seed=42)
    same = train(SVR, TRAINED)
    np.testing.assert_allclose(same.x_scale, alone.x_scale, rtol=0.5 / len(TRAINED))
    x = TESTED[VARIABLES].to_numpy()
    np.testing.assert_allclose(same.predict(x), alone.predict(x), atol=0.05)


def test_the_model_meets_rows_as_they_are():
    model = train(SVR)
    assert own_standardisation.as_tested(model, "rest-together") is model
    x = TESTED[VARIABLES].to_numpy()
    np.testing.assert_array_equal(model.predict(x[:1]), model.predict(x)[:1])


def test_what_cannot_be_is_refused():
    with pytest.raises(InputError, match="-together: expected a learner that standardises"):
        train(learners.of_job({"kind": "durationmean", "bin_hours": 6, "variables": ["duration"]}))
    broken = TESTED.assign(inc=np.nan)
    assert "learning variable inc: expected finite values only" in refusal(train, SVR, broken)
    with pytest.raises(InputError, match="correct: test: expected one that needs no other model"):
        opml.correct(train(SVR), TESTED, test="rest-together")
