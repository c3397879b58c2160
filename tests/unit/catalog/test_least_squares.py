"""Least squares on small problems whose minimum is known."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from opml.catalog.fit.least_squares import (
    CONVERGED,
    NO_STEP,
    NOT_CONVERGED,
    NOT_FINITE,
    UNDERDETERMINED,
    Evaluation,
    Fit,
    Method,
)

T = np.linspace(0.0, 4.0, 30)
TRUE = np.array([2.0, 0.7, 1.5])
START = np.array([1.2, 0.3, 1.3])
SIGMA = 0.01
ANY = Method(scales=np.ones(3), free=np.ones(3, bool), convergence=1e-6)


def oscillation(p):
    """A damped oscillation at times T (m,), and its derivatives (m, 3)."""
    a, decay, rate = p
    envelope, cosine, sine = np.exp(-decay * T), np.cos(rate * T), np.sin(rate * T)
    derivatives = [envelope * cosine, -a * T * envelope * cosine, -a * T * envelope * sine]
    return a * envelope * cosine, np.stack(derivatives, axis=1)


def against(measured):
    """The evaluation of the oscillation against what was measured of it."""

    def evaluate(p):
        predicted, derivatives = oscillation(p)
        return Evaluation((measured - predicted) / SIGMA, derivatives / SIGMA)

    return evaluate


EXACT = against(oscillation(TRUE)[0])
NOISY = against(oscillation(TRUE)[0] + SIGMA * np.random.default_rng(1).normal(size=len(T)))
WORSE = Evaluation(np.full(len(T), 1e9), np.ones((len(T), 3)))


def linear(p):
    """A straight line through points that scatter about it, and a parameter for each of its two ends."""
    part = T / T[-1]
    design = np.stack([1.0 - part, part], axis=1)
    measured = 3.0 + T + 0.1 * np.sin(7.0 * T)
    return Evaluation(measured - design @ p, design)


def valley(p):
    """Rosenbrock's curved valley, with its minimum at (1, 1)."""
    x, y = p
    return Evaluation(-np.array([10.0 * (y - x * x), 1.0 - x]), np.array([[-20.0 * x, 10.0], [-1.0, 0.0]]))


def fitted(evaluate, start=START, method=ANY, iterations=200):
    fit = Fit(np.asarray(start, float), method)
    for _ in range(iterations):
        if not fit.running:
            break
        fit.take(evaluate(fit.trial))
    return fit


def test_exact_measurements_give_the_truth():
    fit = fitted(EXACT)
    assert fit.reason == CONVERGED
    assert fit.converged
    assert not fit.running
    np.testing.assert_allclose(fit.best, TRUE, rtol=0.0, atol=1e-8)
    assert fit.cost < 1e-9


def test_noisy_measurements_give_scipys_minimum_and_cost():
    fit = fitted(NOISY)
    theirs = least_squares(
        lambda p: NOISY(p).residuals, START, lambda p: -NOISY(p).jacobian, method="lm", xtol=1e-15
    )
    doubt = np.sqrt(np.diag(fit.covariance))
    assert np.abs((fit.best - theirs.x) / doubt).max() < ANY.convergence
    assert fit.cost == pytest.approx(2.0 * theirs.cost, rel=1e-12)
    assert np.linalg.norm((fit.best - TRUE) / doubt) < 4.0


def test_the_way_down_a_curved_valley():
    fit = fitted(valley, [-1.2, 1.0], Method(np.ones(2), np.ones(2, bool), 1e-8))
    assert fit.converged
    np.testing.assert_allclose(fit.best, [1.0, 1.0], atol=1e-6)
    assert fit.iterations < 100


def test_the_covariance_is_the_inverse_of_the_normal_matrix():
    fit = fitted(NOISY)
    jacobian = NOISY(fit.best).jacobian
    np.testing.assert_allclose(fit.covariance, np.linalg.inv(jacobian.T @ jacobian), rtol=1e-6)
    np.testing.assert_allclose(fit.covariance, fit.covariance.T, rtol=1e-12)


def test_units_of_the_parameters_make_no_difference():
    units = np.array([1e3, 1e-3, 10.0])

    def in_units(p):
        found = NOISY(p * units)
        return Evaluation(found.residuals, found.jacobian * units)

    fit, other = fitted(NOISY), fitted(in_units, START / units, Method(1.0 / units, ANY.free, 1e-6))
    assert other.iterations == fit.iterations
    np.testing.assert_allclose(other.best * units, fit.best, rtol=1e-9)
    np.testing.assert_allclose(other.covariance * np.outer(units, units), fit.covariance, rtol=1e-6)


def test_damping_grows_while_steps_fail_and_turns_them_downhill():
    fit = Fit(START, ANY)
    fit.take(EXACT(fit.trial))
    cost, steps = fit.cost, [fit.trial - fit.best]
    for _ in range(12):
        fit.take(WORSE)
        steps.append(fit.trial - fit.best)
    assert fit.running
    assert fit.cost == cost
    np.testing.assert_array_equal(fit.best, START)
    lengths = np.linalg.norm(steps, axis=1)
    assert np.all(np.diff(lengths) < 0.0)
    # Ten times the damping is a tenth of the step, once it outweighs the normal matrix.
    assert lengths[-2] / lengths[-1] == pytest.approx(10.0, rel=5e-2)
    start = EXACT(START)
    downhill = start.jacobian.T @ start.residuals
    np.testing.assert_allclose(
        steps[-1] / lengths[-1], downhill / np.linalg.norm(downhill), rtol=0.0, atol=1e-2
    )


def test_the_cost_never_grows():
    fit, costs = Fit(np.array([-1.2, 1.0]), Method(np.ones(2), np.ones(2, bool), 1e-8)), []
    rejected = 0
    while fit.running:
        trial = valley(fit.trial)
        rejected += trial.cost > fit.cost
        fit.take(trial)
        costs.append(fit.cost)
    assert rejected > 0
    assert np.all(np.diff(costs) <= 0.0)


def test_a_trial_without_an_evaluation_is_a_step_that_failed():
    fit = Fit(START, ANY)
    fit.take(EXACT(fit.trial))
    before = fit.trial - fit.best
    fit.reject("lost")
    assert fit.running
    assert fit.iterations == 2
    assert np.linalg.norm(fit.trial - fit.best) < np.linalg.norm(before)
    while fit.running:
        fit.take(EXACT(fit.trial))
    np.testing.assert_allclose(fit.best, TRUE, atol=1e-8)


@pytest.mark.parametrize(
    ("end", "reason"),
    [
        (lambda fit: fit.reject("lost"), "lost"),
        (lambda fit: fit.take(Evaluation(np.full(9, np.nan), np.ones((9, 3)))), NOT_FINITE),
    ],
)
def test_a_start_that_cannot_be_evaluated_ends_the_fit(end, reason):
    fit = Fit(START, ANY)
    end(fit)
    assert (fit.running, fit.converged, fit.reason, fit.iterations) == (False, False, reason, 1)
    np.testing.assert_array_equal(fit.best, START)
    assert np.isnan(fit.covariance).all()
    assert fit.cost == np.inf


def test_nothing_that_lowers_the_residuals_ends_the_fit_where_it_was():
    fit = Fit(START, ANY)
    fit.take(EXACT(fit.trial))
    while fit.running:
        fit.take(WORSE)
    assert fit.reason == NO_STEP
    np.testing.assert_array_equal(fit.best, START)


def test_a_held_parameter_stays_and_has_no_covariance():
    free = np.array([True, False, True])
    start = np.array([1.2, TRUE[1], 1.3])
    fit = fitted(EXACT, start, Method(np.ones(3), free, 1e-6))
    assert fit.converged
    assert fit.best[1] == TRUE[1]
    np.testing.assert_allclose(fit.best, TRUE, atol=1e-8)
    assert not fit.covariance[1].any()
    assert not fit.covariance[:, 1].any()
    jacobian = EXACT(fit.best).jacobian[:, free]
    np.testing.assert_allclose(
        fit.covariance[np.ix_(free, free)], np.linalg.inv(jacobian.T @ jacobian), rtol=1e-6
    )


def test_fewer_residuals_than_parameters():
    fit = fitted(lambda p: Evaluation(NOISY(p).residuals[:2], NOISY(p).jacobian[:2]))
    assert (fit.reason, fit.converged, fit.iterations) == (UNDERDETERMINED, False, 1)
    np.testing.assert_array_equal(fit.best, START)
    assert np.isfinite(fit.covariance).all()


def test_the_last_step_is_taken_unseen_where_its_evaluation_could_not_change_it():
    seen = []

    def watched(p):
        seen.append(p)
        return NOISY(p)

    early, late = fitted(watched, method=Method(ANY.scales, ANY.free, 1e-3)), fitted(NOISY)
    assert early.converged
    assert early.iterations == len(seen) < late.iterations
    assert not np.array_equal(early.best, seen[-1])
    doubt = np.sqrt(np.diag(late.covariance))
    assert np.abs((early.best - late.best) / doubt).max() < 1e-3
    assert np.abs((seen[-1] - late.best) / doubt).max() > 1e-3
    # The cost is that of the place nobody has looked at.
    assert early.cost == pytest.approx(NOISY(early.best).cost, abs=1e-6)


def test_no_time_to_converge():
    fit = fitted(NOISY, iterations=2)
    assert (fit.running, fit.converged, fit.reason, fit.iterations) == (True, False, NOT_CONVERGED, 2)


def test_what_is_known_beforehand_is_one_more_residual():
    mean, sigma = 4.0, 0.5

    def known(p):
        found = linear(p)
        column = np.array([[1.0 / sigma, 0.0]])
        return Evaluation(
            np.append(found.residuals, (mean - p[0]) / sigma), np.vstack([found.jacobian, column])
        )

    method = Method(np.ones(2), np.ones(2, bool), 1e-9)
    without, given = fitted(linear, [0.0, 0.0], method), fitted(known, [0.0, 0.0], method)
    # The weighted mean of two estimates of one parameter.
    own = without.covariance[0, 0]
    expected = (without.best[0] / own + mean / sigma**2) / (1.0 / own + 1.0 / sigma**2)
    assert given.best[0] == pytest.approx(expected, abs=1e-9)
    assert given.covariance[0, 0] == pytest.approx(1.0 / (1.0 / own + 1.0 / sigma**2), rel=1e-9)
