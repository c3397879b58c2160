"""The dual problem of epsilon support vector regression with a Gaussian kernel, by decomposition.

With beta = alpha - alpha*, minimise 1/2 beta' K beta - y' beta + epsilon sum |beta_k| over |beta_k| <= c_k
and sum beta_k = 0, with the entries K_kl of `gaussian_kernel`. A sweep takes a working set of about a
thousand variables: the worst violators of the optimality conditions, and all free variables (neither 0 nor
at a limit). It computes their kernel entries by one matrix product and moves pairs of them until they are ten
times nearer to the optimum, as ThunderSVM does (Wen, Shi, Li, He & Chen 2018, J. Mach. Learn. Res. 19(21)).
Only variables that moved need a whole row of the kernel matrix, for the gradient of all others.

The solver stops where libsvm does, when no two slopes differ by tol (Chang & Lin 2011, ACM Trans. Intell.
Syst. Technol. 2(27), section 4.1). As in libsvm, kernel entries are computed in double and kept in single
precision, and gradients are sums in double.
"""

import warnings

import numpy as np
from threadpoolctl import threadpool_limits

from opml.base.errors import InputError
from opml.learning.models import smo_kernels as kernels
from opml.learning.models.gaussian_kernel import exponent_factors

WORKING = 1024  # least number of variables in a working set
ENTERING = 512  # worst violators in a working set
SPARE = 256  # least number of variables in a working set that moved before and are not free
MOST_WORKING = 6144  # 150 MB of kernel entries
LOCAL = 0.1  # share of the violation that a sweep may leave in its working set
# Kernel rows kept in memory. A variable that moves again usually moved a few sweeps ago, so more rows are
# seldom reused.
KEPT = 1024
ROWS, COLUMNS = 256, 512  # of a block of exponents: 1 MB, within the cache of a core; KEPT is no less
MOST_SWEEPS = 100_000  # a hundred are enough, unless tol is below what rounding leaves
MOST_STEPS = 1_000_000  # in one sweep


def solve(
    z: np.ndarray, y: np.ndarray, limits: np.ndarray, *, epsilon: float, tol: float
) -> tuple[np.ndarray, float, int]:
    """Return dual coefficients beta (n,), the offset of the function, and the number of pairs moved.

    z: (n, variables) rows in units of the kernel scale
    y: (n,) targets
    limits: (n,) c_k
    tol: largest difference of two slopes at the optimum

    Raises InputError where no limit is above 0. Warns where it stops before tol is reached.
    """
    if not np.any(limits > 0.0):
        raise InputError("weights: expected one above 0, got none")
    with threadpool_limits(limits=1, user_api="blas"):  # sums in one order, whatever the machine
        return _Descent(z, y, limits, epsilon=epsilon, tol=tol).run()


class _KernelRows:
    """Rows of the kernel matrix; those used last are kept in single precision."""

    def __init__(self, z: np.ndarray) -> None:
        count = len(z)
        self._left, self._right = exponent_factors(z)  # in double, because terms of their product cancel
        kept = min(count, KEPT)
        self._kept = np.empty((kept, count), dtype=np.float32)
        self._owner = np.full(kept, -1)  # the variable whose row is kept in a place
        self._place = np.full(count, -1)  # the place where a variable's row is kept
        self._used = np.zeros(kept, dtype=np.int64)  # when the row in a place was used last
        self._clock = 0
        # Memory used again and again: new pages cost more than writing into them.
        self._exponents = np.empty(ROWS * COLUMNS)
        self._entries = np.empty(0, dtype=np.float32)

    def block(self, chosen: np.ndarray) -> np.ndarray:
        """Return kernel entries (q, q) between chosen rows, valid until the next call."""
        if self._entries.size < len(chosen) ** 2:
            self._entries = np.empty(len(chosen) ** 2, dtype=np.float32)
        entries = self._entries[: len(chosen) ** 2].reshape(len(chosen), len(chosen))
        right = np.ascontiguousarray(self._right[:, chosen])
        for start in range(0, len(chosen), ROWS):
            part = chosen[start : start + ROWS]
            self._fill(entries, np.arange(start, start + len(part)), self._left[part], right)
        return entries

    def add(self, chosen: np.ndarray, weights: np.ndarray, total: np.ndarray) -> None:
        """Add the chosen rows times their weights to total (n,)."""
        self._clock += 1
        kept = self._place[chosen] >= 0
        places = self._place[chosen[kept]]
        self._used[places] = self._clock
        kernels.accumulate(self._kept, places, weights[kept], total)
        missing, weights = chosen[~kept], weights[~kept]
        for start in range(0, len(missing), ROWS):
            places = self._keep(missing[start : start + ROWS])
            kernels.accumulate(self._kept, places, weights[start : start + ROWS], total)

    def _keep(self, chosen: np.ndarray) -> np.ndarray:
        """Compute rows in the places of those unused for longest; return the places."""
        places = np.sort(np.argsort(self._used, kind="stable")[: len(chosen)])
        forgotten = self._owner[places]
        self._place[forgotten[forgotten >= 0]] = -1
        self._owner[places], self._place[chosen], self._used[places] = chosen, places, self._clock
        self._fill(self._kept, places, self._left[chosen], self._right)
        return places

    def _fill(self, out: np.ndarray, places: np.ndarray, left: np.ndarray, right: np.ndarray) -> None:
        """Write exp(left @ right), (a, b), into rows `places` (a,) of `out`, block by block of columns."""
        for start in range(0, right.shape[1], COLUMNS):
            part = right[:, start : start + COLUMNS]
            exponents = self._exponents[: len(left) * part.shape[1]].reshape(len(left), part.shape[1])
            np.matmul(left, part, out=exponents)
            kernels.exponentiate(exponents, out, places, start)


class _Descent:
    """The state between sweeps: coefficients, the gradient K beta - y, slopes, and when each moved last."""

    def __init__(
        self, z: np.ndarray, y: np.ndarray, limits: np.ndarray, *, epsilon: float, tol: float
    ) -> None:
        self.rows = _KernelRows(z)
        self.limits, self.epsilon, self.tol = limits, epsilon, tol
        self.beta, self.gradient = np.zeros(len(y)), -y
        self.up, self.down = np.empty(len(y)), np.empty(len(y))
        self.moved = np.zeros(len(y), dtype=np.int64)  # the last sweep that moved it, 0 for none
        self.size = min(WORKING, len(y))
        self.steps = 0

    def run(self) -> tuple[np.ndarray, float, int]:
        """Sweep until no two slopes differ by tol; warn where that takes too many sweeps."""
        for sweep in range(1, MOST_SWEEPS + 1):
            kernels.slopes(self.beta, self.gradient, self.limits, self.epsilon, self.up, self.down)
            violation = float(self.down.max() - self.up.min())
            if violation < self.tol:
                break
            self._sweep(sweep, max(0.5 * self.tol, LOCAL * violation))
        else:
            warnings.warn(
                f"SVR: stopped after {MOST_SWEEPS} sweeps, slopes off by {violation:.1e}; tol {self.tol:.1e}",
                stacklevel=3,
            )
        return self.beta, self._offset(), self.steps

    def _sweep(self, sweep: int, tol: float) -> None:
        """Move the variables of a working set until their slopes differ by less than tol."""
        chosen = self._working_set(sweep)
        beta, before = self.beta[chosen], self.beta[chosen]
        self.steps += kernels.descend(
            self.rows.block(chosen),
            beta,
            self.gradient[chosen],
            self.limits[chosen],
            self.epsilon,
            tol,
            MOST_STEPS,
        )
        changed = beta != before
        moved = chosen[changed]
        self.beta[moved], self.moved[moved] = beta[changed], sweep
        self.rows.add(moved, (beta - before)[changed], self.gradient)

    def _working_set(self, sweep: int) -> np.ndarray:
        """Return variables, ascending: the worst violators, all free ones, then those that moved last."""
        # One number ranks three classes. A violator has 2 sweep, a free variable sweep to 2 sweep, any other
        # variable less than sweep: the sweep that moved it last, or 0.
        rank = self.moved.copy()
        rank[self._free()] += sweep
        worst = min(ENTERING // 2, len(rank) - 1)
        for slopes in (self.up, -self.down):
            rank[np.argpartition(slopes, worst)[: worst + 1]] = 2 * sweep
        wanted = int(np.count_nonzero(rank >= sweep)) + SPARE
        # A set is never smaller than the one before.
        self.size = max(self.size, min(wanted, MOST_WORKING, len(rank)))
        chosen = np.sort(np.argpartition(-rank, self.size - 1)[: self.size])
        return chosen[rank[chosen] > 0]  # 0: no violator, and never moved

    def _free(self) -> np.ndarray:
        """Return which variables (n,) are neither 0 nor at a limit."""
        return (self.beta != 0.0) & (np.abs(self.beta) < self.limits)

    def _offset(self) -> float:
        """Return minus the slope of the free variables, which agree; without any, the middle of its range."""
        free = self._free()
        if free.any():
            return -float(np.mean(self.gradient[free] + self.epsilon * np.sign(self.beta[free])))
        return -0.5 * float(self.up.min() + self.down.max())
