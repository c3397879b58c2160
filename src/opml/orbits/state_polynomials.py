"""States of an orbit between others: polynomials of Hermite through four (CCSDS 502.0-B-2, 5.2.3.5)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

FEWEST = 4  # states that a polynomial goes through, two before a time and two after it


@dataclass(frozen=True, eq=False)
class StatePolynomials:
    """An orbit through states: of degree 7, with the positions and the velocities of four."""

    t: np.ndarray  # (n,) ascending, FEWEST or more [s]
    states: np.ndarray  # (n, 6) position and velocity, in any units that go together

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return states (m, 6) at times (m,) [s] by the polynomials through the four states about each."""
        first = np.clip(np.searchsorted(self.t, t) - FEWEST // 2, 0, len(self.t) - FEWEST)
        coefficients = self._coefficients[:, first]
        beyond = (t - self.t[first + np.arange(FEWEST)[:, None]])[..., None]
        value, slope = coefficients[-1], np.zeros((len(t), 3))
        for k in range(2 * FEWEST - 2, -1, -1):
            slope = value + slope * beyond[k // 2]
            value = coefficients[k] + value * beyond[k // 2]
        return np.hstack([value, slope])

    @cached_property
    def _coefficients(self) -> np.ndarray:
        """Newton's coefficients (8, n - 3, 3) of the polynomials through four states that follow each other.

        They are the divided differences over each time twice, of which the first is the velocity.
        """
        windows = np.arange(len(self.t) - FEWEST + 1)
        taken = np.repeat(np.arange(FEWEST), 2)[:, None] + windows
        times, differences = self.t[taken][..., None], self.states[taken, :3]
        coefficients = [differences[0]]
        for order in range(1, 2 * FEWEST):
            steps, rises = times[order:] - times[:-order], np.diff(differences, axis=0)
            differences = np.divide(rises, steps, out=self.states[taken[order:], 3:], where=steps > 0.0)
            coefficients.append(differences[0])
        return np.array(coefficients)
