"""The support vector regression against scikit-learn, the unscaled formulation and its own saved form."""

import numpy as np
import pytest
from scipy.spatial.distance import pdist
from sklearn.svm import SVR
from support import refusal

from opml.base.errors import InputError
from opml.learning.models import gaussian_kernel, learners, svr
from opml.learning.models.training_inputs import Training

VARIABLES = ("duration", "d_a", "cd_b", "constant")
SETTINGS = {"kind": "svr", "kernel_scale": "sigest", "c": 1.0, "epsilon": 0.1, "tol": 1e-3}


def sample(count, seed=0):
    """Rows of 20 estimates whose error grows with the duration squared, in metres."""
    rng = np.random.default_rng(seed)
    groups = rng.integers(0, 20, count)
    drag = np.random.default_rng(99).normal(2.2, 0.05, 20)[groups]
    duration = rng.uniform(0.0, 6e5, count)
    x = np.column_stack([duration, rng.normal(0.0, 300.0, count), drag, np.full(count, 0.1)])
    y = 2e4 * (drag - 2.2) / 0.05 * (duration / 6e5) ** 2 + 50.0 * rng.normal(size=count)
    return x, y


def fit(x, y, *, variables=VARIABLES, seed=42, weights=None, **changes):
    training = Training(x, y, variables, seed, weights=weights)
    return svr.fit(training, svr.SvrSettings(**SETTINGS | changes))


@pytest.fixture(scope="module")
def model():
    x, y = sample(400)
    return fit(x, y)


def standardised(model, x):
    return (x - model.x_mean) / model.x_scale


def reference(model, x, y):
    """scikit-learn's machine (libsvm) at the model's own settings."""
    machine = SVR(gamma=1.0 / model.kernel_scale**2, C=model.c, epsilon=model.epsilon, tol=model.tol)
    return machine.fit(standardised(model, x), y / model.y_scale)


@pytest.mark.parametrize("tol", [1e-3, 1e-6])
def test_predicts_as_scikit_learn_does(tol):
    # Both stop when the conditions of the optimum hold to tol, at different points.
    x, y = sample(400)
    new, _ = sample(3000, seed=1)
    model = fit(x, y, tol=tol)
    expected = reference(model, x, y).predict(standardised(model, new)) * model.y_scale
    np.testing.assert_allclose(model.predict(new), expected, rtol=0, atol=2.0 * tol * model.y_scale)
    assert np.ptp(expected) > model.y_scale  # a flat prediction would prove nothing


def test_weights_scale_the_box_by_their_root():
    x, y = sample(400)
    weights = np.linspace(0.1, 2.0, 400)
    found = fit(x, y, tol=1e-6, weights=weights)
    machine = SVR(gamma=1.0 / found.kernel_scale**2, C=1.0, epsilon=0.1, tol=1e-6)
    machine.fit(standardised(found, x), y / found.y_scale, np.sqrt(weights))
    expected = machine.predict(standardised(found, x)) * found.y_scale
    np.testing.assert_allclose(found.predict(x), expected, rtol=0, atol=2e-6 * found.y_scale)


def test_same_function_as_the_unscaled_formulation():
    # fitrsvm's defaults on the raw target: C = iqr/1.349, epsilon = iqr/13.49. Solved tightly, both must
    # agree.
    x, y = sample(300)
    model = fit(x, y, tol=1e-9)
    q1, q3 = np.quantile(y, [0.25, 0.75], method="hazen")
    machine = SVR(
        gamma=1.0 / model.kernel_scale**2, C=(q3 - q1) / 1.349, epsilon=(q3 - q1) / 13.49, tol=1e-7
    ).fit(standardised(model, x), y)
    new, _ = sample(500, seed=1)
    np.testing.assert_allclose(
        model.predict(new), machine.predict(standardised(model, new)), rtol=0, atol=1e-6 * model.y_scale
    )


def test_target_in_other_units_changes_nothing_else(model):
    # Velocity components are 1e-3 of position ones: the tolerance must not swallow them. A power of two is
    # exact.
    x, y = sample(400)
    small = fit(x, y * 2.0**-12)
    assert small.iterations == model.iterations
    np.testing.assert_array_equal(small.predict(x) * 2.0**12, model.predict(x))


def test_variables_are_standardised_with_the_sample_deviation(model):
    x, _ = sample(400)
    np.testing.assert_allclose(model.x_mean, x.mean(axis=0))
    np.testing.assert_allclose(model.x_scale[:3], x[:, :3].std(axis=0, ddof=1))


def test_constant_variable_neither_breaks_nor_counts(model):
    x, y = sample(400)
    assert model.x_scale[3] == 1.0
    without = fit(x[:, :3], y, variables=VARIABLES[:3])
    np.testing.assert_allclose(without.predict(x[:, :3]), model.predict(x), rtol=0, atol=1e-9 * model.y_scale)


def test_target_without_interquartile_range_keeps_its_unit():
    x, _ = sample(50)
    y = np.zeros(50)
    y[:5] = 3.0
    assert fit(x, y).y_scale == 1.0


def test_flat_target_needs_no_support_vector():
    x, _ = sample(50)
    model = fit(x, np.full(50, 0.05))
    assert len(model.dual_coef) == 0
    np.testing.assert_allclose(model.predict(x), 0.05, atol=0.1)


def test_sigest_is_the_lower_end_of_kernlabs_range():
    x, y = sample(300)
    model = fit(x, y)
    # kernlab: sigma from 1 / quantile(|x - z|^2, 0.9) to 1 / quantile(|x - z|^2, 0.1), for exp(-sigma |x -
    # z|^2).
    squares = pdist(standardised(model, x)) ** 2
    sigma = 1.0 / np.quantile(squares, 0.1)
    assert 1.0 / model.kernel_scale**2 == pytest.approx(sigma, rel=1e-3)
    assert model.kernel_rule == "sigest"


def test_median_rule_and_a_number():
    x, y = sample(300)
    model = fit(x, y, kernel_scale="median")
    assert model.kernel_scale == pytest.approx(np.median(pdist(standardised(model, x))))
    assert fit(x, y, kernel_scale=2).kernel_scale == 2.0


def test_subsample_is_seeded_and_stands_for_the_whole(monkeypatch):
    x, y = sample(1500)
    whole = fit(x, y).kernel_scale
    monkeypatch.setattr(gaussian_kernel, "DISTANCE_ROWS", 500)
    part = fit(x, y).kernel_scale
    assert part == fit(x, y).kernel_scale
    assert part != whole
    assert part == pytest.approx(whole, rel=0.05)
    other = fit(x, y, seed=43)
    assert other.kernel_scale != part


@pytest.mark.parametrize("rule", ["auto", 0.0, -1.0, float("nan"), float("inf"), True, None])
def test_bad_kernel_scale(rule):
    with pytest.raises(InputError, match="kernel_scale: expected sigest, median or a number above 0, got"):
        learners.settings_of(SETTINGS | {"kernel_scale": rule})


def test_bad_rows(model):
    x, y = sample(50)
    assert "at least 2, got 1" in refusal(fit, x[:1], y[:1])
    assert "expected 4 columns" in refusal(model.predict, x[:, :3])
    assert "coincident rows" in refusal(fit, np.ones((10, 4)), y[:10])
