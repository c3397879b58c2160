"""Weighted least squares on the normal equations, with the damped steps of Levenberg and Marquardt.

Arrays only. A `Fit` names the parameters p to try next and the caller evaluates its model there, so that many
fits can be evaluated side by side:

    fit = Fit(start, method)
    while fit.running:
        fit.take(Evaluation(residuals(fit.trial), jacobian(fit.trial)))

With r = (measured - predicted) / sigma, the weighted residuals, and A, the derivatives of predicted / sigma:

    N = A'A,  g = A'r                    normal equations
    (S N S + d I) u = S g,  dp = S u     step dp, damped by d in the scales S = diag(s)
    l = sqrt(g' dp),  d -> 0             what the full step moves, in formal uncertainties
    P = N^-1                             formal covariance

A step is accepted where r'r does not grow; the next step is then damped less, else more. A parameter that is
held has no row in N. What is known of a parameter beforehand is one more residual, (mean - p) / sigma, with
1 / sigma in its column of A.

Levenberg 1944, Quarterly of Applied Mathematics 2, 164-168; Marquardt 1963, Journal of SIAM 11, 431-441;
Tapley, Schutz & Born 2004, Statistical Orbit Determination, ch. 4.
"""

from dataclasses import dataclass

import numpy as np

CONVERGED = ""
NOT_CONVERGED = "not converged"
UNDERDETERMINED = "fewer measurements than parameters"
NO_STEP = "no step lowers the residuals"
NOT_FINITE = "residuals not finite"

_FIRST_DAMPING = 1e-3
_LEAST_DAMPING = 1e-12
_MOST_DAMPING = 1e12
_LESS, _MORE = 0.1, 10.0
"""Factors of the damping after a step that was accepted, and after a step that was not."""


@dataclass(frozen=True)
class Method:
    """Scales, free parameters and convergence of a fit of n parameters."""

    scales: np.ndarray  # (n,) units in which the damping measures a step, such as a-priori uncertainties
    free: np.ndarray  # (n,) bool, False where a parameter is held at its start
    convergence: float  # part of the formal uncertainty that a last step may still move

    def step(self, normal: np.ndarray, gradient: np.ndarray, damping: float = _LEAST_DAMPING) -> np.ndarray:
        """Return the step (n,) of the parameters, full unless damped; 0 where a parameter is held."""
        scales = self.scales[self.free]
        scaled = np.linalg.solve(self._scaled(normal, damping), scales * gradient[self.free])
        step = np.zeros(len(self.scales))
        step[self.free] = scales * scaled
        return step

    def covariance(self, normal: np.ndarray) -> np.ndarray:
        """Return the formal covariance (n, n); 0 where a parameter is held."""
        scales = self.scales[self.free]
        scaled = np.linalg.inv(self._scaled(normal, _LEAST_DAMPING))
        covariance = np.zeros(normal.shape)
        covariance[np.ix_(self.free, self.free)] = scaled * np.outer(scales, scales)
        return covariance

    def _scaled(self, normal: np.ndarray, damping: float) -> np.ndarray:
        """Return the free parameters' normal matrix in units of their scales, damped."""
        scales = self.scales[self.free]
        scaled: np.ndarray = normal[np.ix_(self.free, self.free)] * np.outer(scales, scales)
        return scaled + damping * np.eye(len(scales))


@dataclass(frozen=True)
class Evaluation:
    """The model at some parameters: weighted residuals (m,), and the Jacobian (m, n) of what it predicts."""

    residuals: np.ndarray
    jacobian: np.ndarray

    @property
    def cost(self) -> float:
        """Sum of the squared residuals."""
        return float(np.sum(self.residuals**2))

    def and_also(self, more: "Evaluation") -> "Evaluation":
        """Return the evaluation with further residuals and their rows of the Jacobian."""
        residuals = np.append(self.residuals, more.residuals)
        return Evaluation(residuals, np.vstack([self.jacobian, more.jacobian]))


class Fit:
    """A fit in progress: `best` has the lowest `cost` so far, `trial` is to be evaluated next.

    It is `running` until it ends with a `reason`, which is CONVERGED where it converged; `iterations` counts
    the trials. `normal` and `gradient` belong to `best`, and are not finite before the first evaluation.
    """

    def __init__(self, start: np.ndarray, method: Method) -> None:
        self.method = method
        self.best = self.trial = start
        self.cost = np.inf
        self.normal = np.full((len(start), len(start)), np.nan)
        self.gradient = np.full(len(start), np.nan)
        self.iterations = 0
        self.running, self.reason = True, NOT_CONVERGED
        self._damping = _FIRST_DAMPING
        self._left = 0.0  # what the full step moves, in formal uncertainties

    @property
    def converged(self) -> bool:
        """Whether the best parameters are those of the minimum."""
        return self.reason == CONVERGED

    @property
    def covariance(self) -> np.ndarray:
        """Formal covariance (n, n) of the best parameters; not finite where nothing was evaluated."""
        return self.method.covariance(self.normal) if self.started else np.full(self.normal.shape, np.nan)

    def take(self, evaluation: Evaluation) -> None:
        """Go on from the trial where it is no worse than the best, or damp the step to the next one more."""
        cost = evaluation.cost
        if not np.isfinite(cost):
            self.reject(NOT_FINITE)
            return
        self.iterations += 1
        if cost > self.cost:
            self._damping *= _MORE
        else:
            self._accept(evaluation)
        self._try_next()

    def reject(self, why: str) -> None:
        """Damp the step more, as the trial cannot be evaluated; at the start, end with the reason why."""
        self.iterations += 1
        if self.started:
            self._damping *= _MORE
            self._try_next()
        else:
            self._end(why)

    @property
    def started(self) -> bool:
        """Whether the model could be evaluated at the start, or at a later trial."""
        return bool(np.isfinite(self.cost))

    def _accept(self, evaluation: Evaluation) -> None:
        self.best, self.cost = self.trial, evaluation.cost
        self.normal = evaluation.jacobian.T @ evaluation.jacobian
        self.gradient = evaluation.jacobian.T @ evaluation.residuals
        self._damping = max(_LESS * self._damping, _LEAST_DAMPING)
        if len(evaluation.residuals) < len(self.best):
            self._end(UNDERDETERMINED)

    def _try_next(self) -> None:
        """Set the next trial by a damped step, or end the fit."""
        if not self.running:
            return
        if self._damping > _MOST_DAMPING:
            self._end(NO_STEP)
            return
        # What is left to go is the full step's length, as damping alone can make a step short.
        full = self.method.step(self.normal, self.gradient)
        before, self._left = self._left, float(np.sqrt(self.gradient @ full))
        if self._left < self.method.convergence:
            self._end(CONVERGED)
            return
        step = self.method.step(self.normal, self.gradient, self._damping)
        self.trial = self.best + step
        if self._is_last(full - step, before):
            self.best, self.cost = self.trial, max(0.0, self.cost - self._left**2)
            self._end(CONVERGED)

    def _is_last(self, damped_off: np.ndarray, before: float) -> bool:
        """Whether the trial will be found to be the minimum, so that evaluating it would only confirm it.

        Steps shrink ever faster near the end: by the rate of the last one, `before` to what is left now, the
        next will be left^2 / before. damped_off: what damping takes off the trial's step, which comes on top.
        """
        short = np.sqrt(max(0.0, damped_off @ self.normal @ damped_off))
        return bool(self._left**2 < (self.method.convergence - short) * before)

    def _end(self, reason: str) -> None:
        self.running, self.reason = False, reason
