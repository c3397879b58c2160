"""The SVR's solver against libsvm (scikit-learn's SVR), and against the conditions of an optimum."""

import numpy as np
import pytest
from sklearn.svm import SVR
from threadpoolctl import threadpool_limits

from opml.base.errors import InputError
from opml.learning.judge import metrics
from opml.learning.models import smo
from opml.learning.models.gaussian_kernel import expansion

EPSILON = 0.1
TIGHT = 1e-5


def sample(count, seed=0):
    """Standardised rows, of which some are outliers, and a target of unit size with heavy tails."""
    rng = np.random.default_rng(seed)
    z = rng.normal(size=(count, 8))
    z[::40] *= 3.0
    y = np.tanh(z[:, 0]) * z[:, 1] + 0.5 * np.sin(2.0 * z[:, 2]) + 0.1 * rng.standard_t(3, count)
    return z, y


def limits_of(count, c, *, weighted):
    return c * (np.random.default_rng(7).uniform(0.2, 1.4, count) if weighted else np.ones(count))


def libsvm(z, y, limits, *, tol):
    """Coefficients and offset of libsvm; the limits are sample weights times C = 1."""
    machine = SVR(gamma=1.0, C=1.0, epsilon=EPSILON, tol=tol, cache_size=500).fit(z, y, limits)
    beta = np.zeros(len(y))
    beta[machine.support_] = machine.dual_coef_.ravel()
    return beta, machine.intercept_[0]


def gradient(z, y, beta):
    return expansion(z, z, beta) - y


def objective(z, y, beta):
    return 0.5 * beta @ (gradient(z, y, beta) - y) + EPSILON * np.abs(beta).sum()


def violation(z, y, beta, limits):
    """How far any two slopes are apart, from kernel entries in double precision."""
    slopes = gradient(z, y, beta)
    up = np.where(beta < limits, slopes + np.where(beta >= 0.0, EPSILON, -EPSILON), np.inf)
    down = np.where(beta > -limits, slopes + np.where(beta > 0.0, EPSILON, -EPSILON), -np.inf)
    return down.max() - up.min()


def rounding(beta):
    """What kernel entries of single precision may do to two slopes; libsvm's are as far off."""
    return 2.0 * float(np.finfo(np.float32).eps) * np.linalg.norm(beta)


def assert_feasible(beta, limits):
    assert np.all(np.abs(beta) <= limits)
    assert abs(beta.sum()) < 1e-9 * limits.sum()


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("scale", [1.0, 3.5, 8.0])
@pytest.mark.parametrize("c", [1.0, 10.0, 100.0])
def test_finds_the_optimum_of_libsvm(c, scale, weighted):
    z, y = sample(400)
    z, limits = z / scale, limits_of(400, c, weighted=weighted)
    beta, offset, _ = smo.solve(z, y, limits, epsilon=EPSILON, tol=TIGHT)
    expected = libsvm(z, y, limits, tol=TIGHT)
    assert objective(z, y, beta) == pytest.approx(objective(z, y, expected[0]), rel=1e-6)
    assert_feasible(beta, limits)
    assert violation(z, y, beta, limits) < TIGHT + rounding(beta)

    new, truth = sample(300, seed=1)
    ours, theirs = (expansion(new / scale, z, b) + o for b, o in ((beta, offset), expected))
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-3)
    assert metrics.p_ml(truth, ours) == pytest.approx(metrics.p_ml(truth, theirs), abs=0.01)


@pytest.mark.parametrize("c", [1.0, 10.0])
def test_many_sweeps_with_few_rows_kept(c, monkeypatch):
    z, y = sample(2000)
    z, limits = z / 3.5, limits_of(2000, c, weighted=False)
    monkeypatch.setattr(smo, "WORKING", 64)
    monkeypatch.setattr(smo, "ENTERING", 64)
    monkeypatch.setattr(smo, "KEPT", smo.ROWS)
    beta, _, _ = smo.solve(z, y, limits, epsilon=EPSILON, tol=1e-3)
    whole, _ = libsvm(z, y, limits, tol=1e-3)
    assert_feasible(beta, limits)
    assert violation(z, y, beta, limits) < 1.01e-3
    assert objective(z, y, beta) < objective(z, y, whole) * (1.0 - 1e-5)  # both are negative


def test_more_free_variables_than_a_working_set_may_hold(monkeypatch):
    z, y = sample(400)
    z, limits = z / 3.5, limits_of(400, 100.0, weighted=False)
    monkeypatch.setattr(smo, "WORKING", 32)
    monkeypatch.setattr(smo, "ENTERING", 16)
    monkeypatch.setattr(smo, "MOST_WORKING", 32)
    beta, _, _ = smo.solve(z, y, limits, epsilon=EPSILON, tol=1e-3)
    free = (beta != 0.0) & (np.abs(beta) < limits)
    assert np.count_nonzero(free) > 32
    assert violation(z, y, beta, limits) < 1.01e-3


def test_coincident_rows():
    z, y = sample(100)
    z, y = np.repeat(z, 3, axis=0), np.repeat(y, 3)
    y[::3] += 0.5
    limits = np.ones(300)
    beta, _, _ = smo.solve(z, y, limits, epsilon=EPSILON, tol=TIGHT)
    expected, _ = libsvm(z, y, limits, tol=TIGHT)
    assert objective(z, y, beta) == pytest.approx(objective(z, y, expected), rel=1e-6)
    assert violation(z, y, beta, limits) < TIGHT + rounding(beta)


def test_two_rows():
    z, y = np.array([[0.0], [1.0]]), np.array([-1.0, 1.0])
    beta, offset, _ = smo.solve(z, y, np.full(2, 100.0), epsilon=EPSILON, tol=TIGHT)
    np.testing.assert_allclose(expansion(z, z, beta) + offset, [-0.9, 0.9], atol=TIGHT)
    np.testing.assert_array_equal(beta, [-beta[1], beta[1]])


def test_target_within_epsilon_needs_no_step():
    z, _ = sample(50)
    beta, offset, steps = smo.solve(z, np.full(50, 7.0), np.ones(50), epsilon=EPSILON, tol=TIGHT)
    assert steps == 0
    assert not beta.any()
    assert offset == pytest.approx(7.0)


def test_a_row_of_no_weight_counts_for_nothing():
    z, y = sample(200)
    limits = np.ones(200)
    limits[150:] = 0.0
    whole, _, _ = smo.solve(z, y, limits, epsilon=EPSILON, tol=TIGHT)
    part, _, _ = smo.solve(z[:150], y[:150], np.ones(150), epsilon=EPSILON, tol=TIGHT)
    assert not whole[150:].any()
    np.testing.assert_allclose(whole[:150], part, atol=1e-3)
    with pytest.raises(InputError, match="weights: expected one above 0"):
        smo.solve(z, y, np.zeros(200), epsilon=EPSILON, tol=TIGHT)


def test_giving_up_is_told(monkeypatch):
    z, y = sample(400)
    monkeypatch.setattr(smo, "WORKING", 16)
    monkeypatch.setattr(smo, "MOST_SWEEPS", 2)
    with pytest.warns(UserWarning, match="SVR: stopped after 2 sweeps, slopes off by"):
        smo.solve(z, y, np.ones(400), epsilon=EPSILON, tol=1e-3)


def test_same_bytes_whatever_the_threads():
    z, y = sample(1500)
    solutions = []
    for threads in (1, 2):
        with threadpool_limits(threads):
            solutions.append(smo.solve(z / 3.5, y, np.ones(1500), epsilon=EPSILON, tol=1e-3))
    np.testing.assert_array_equal(solutions[0][0], solutions[1][0])
    assert solutions[0][1:] == solutions[1][1:]
