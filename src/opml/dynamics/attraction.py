"""The Earth's gravity at many given places and times, outside of an integrator."""

import numpy as np
import pandas as pd

from opml.dynamics.frames import gcrf_to_itrf
from opml.dynamics.kernels.gravity import gravity, weights
from opml.dynamics.kernels.lanes import WIDTH, entry, load, sqrt, store


class Attraction:
    """The pull of a gravity field that turns with the Earth."""

    def __init__(
        self, c: np.ndarray, s: np.ndarray, *, gm: float, radius: float, earth_orientation: pd.DataFrame
    ) -> None:
        """Take a field, and the Earth orientation table of the times at which it pulls.

        c, s: fully normalised coefficients (degree + 1, degree + 1) [n, m]
        gm: [m3/s2]
        radius: [m]
        """
        self._degree = len(c) - 1
        self._weights = weights(c, s)
        self._gm, self._radius = gm, radius
        self._orientation = earth_orientation

    def rotation(self, t: np.ndarray) -> np.ndarray:
        """Return rotation matrices GCRF to ITRF (n, 3, 3) at times t (n,) [s]."""
        return gcrf_to_itrf(self._orientation, t)

    def acceleration(self, positions: np.ndarray, rotation: np.ndarray) -> np.ndarray:
        """Return accelerations (n, 3) [m/s2] at positions (n, 3) [m], both in GCRF.

        rotation: (n, 3, 3) GCRF to ITRF
        """
        pull = self._in_itrf(np.einsum("nij,nj->in", rotation, positions))
        return np.einsum("nji,jn->ni", rotation, pull)

    def _in_itrf(self, positions: np.ndarray) -> np.ndarray:
        """Return accelerations (3, n) at positions (3, n) in the frame of the field."""
        count = positions.shape[1]
        blocks = -(-count // WIDTH)
        # The last position fills the lanes that are left over.
        filled = np.pad(positions, ((0, 0), (0, blocks * WIDTH - count)), mode="edge")
        places = np.ascontiguousarray(filled).reshape(3, blocks, WIDTH)
        pulls = np.empty((3, blocks, WIDTH))
        _pull(places, pulls, self._weights, self._degree + 2, self._degree + 1, self._gm, self._radius)
        return pulls.reshape(3, -1)[:, :count]


@entry
def _pull(places, pulls, weights, columns, degree, gm, radius):
    """Fill `pulls` (3, blocks, WIDTH) with accelerations at `places`, both in the frame of the field."""
    for k in range(places.shape[1]):
        x, y, z = load(places[0], k), load(places[1], k), load(places[2], k)
        r2 = x * x + y * y + z * z
        inverse_r = 1.0 / sqrt(r2)
        ax, ay, az = gravity(x, y, z, inverse_r, weights, columns, degree, gm, radius)
        central = -gm * inverse_r * inverse_r * inverse_r
        store(pulls[0], k, ax + central * x)
        store(pulls[1], k, ay + central * y)
        store(pulls[2], k, az + central * z)
