"""Estimates by a sequential filter: an extended Kalman filter whose drag coefficient is never at rest.

Track by track, the state and its covariance are carried to the next track's start and meet its measurements
there. All that came before is in them, and fades as the noise has it: no window is chosen.

    Cd = c + gust        c walks at random: it is what lasts, and what the estimates give as Cd
    velocity + impulse   radially and across the orbit: errors of the other forces, which do not heat it

Gusts are white. Without impulses, a Gauss-Markov process in their place explained the innovations of
Swarm A, seen by three radars, the worse the longer it remembered, from 45 minutes on.

Several filters run side by side on the same arcs, each with another noise. At each track speaks the one
whose innovations up to then were likeliest, so that no row rests on what came later. The partial derivatives
come from neighbouring arcs, as those of the batch fits do.

Covariances are carried as roots, P = L L', which stay positive: after a step L is the triangle of [F L, Q],
and a track with the weighted partial derivatives A = H L, of residuals r, gives

    u = (I + A'A)^-1 A'r,  x + L u,  L (I + A'A)^(-1/2)
    chi2 = (r - A u)'(r - A u) + u'u,  ln likelihood = -(chi2 + ln det(I + A'A)) / 2 + constant

Tapley, Schutz & Born 2004, Statistical Orbit Determination, ch. 4.7, 4.9 and 5.7; Magill 1965, IEEE
Transactions on Automatic Control 10, 434-439 (the bank of filters).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.fit.apriori import SCALES, covariance_root, with_apriori_cd
from opml.catalog.fit.least_squares import Evaluation
from opml.catalog.fit.measurements import Measurements
from opml.catalog.fit.neighbour_arcs import NUDGES, propagate_neighbours
from opml.catalog.propagator import Propagator
from opml.dynamics.ensemble import REASONS
from opml.orbits.elements import rsw_rotation
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, symmetric_matrices

STEP = 1800.0  # longest time for which the drag coefficient keeps its value [s]

_CD = PARAMETERS.index("cd")
_PASSES = 4
_CONVERGED = 1e-3
"""Largest step, in formal uncertainties of what was predicted, after which a track is met no more."""


@dataclass(frozen=True)
class Noise:
    """Process noise of a filter: the unknown part of the forces."""

    walk: float  # change of Cd in a day that lasts, as a part of the sheet's
    gust: float  # error of the mean over a day of the Cd that does not last, as a part of the sheet's
    impulse: float  # error of other forces: change of velocity radially and across the orbit in a day [m/s]


BANK = tuple(
    Noise(walk, gust, impulse)
    for walk in (0.01, 0.03, 0.1)
    for gust in (0.02, 0.05, 0.1)
    for impulse in (5e-4, 4e-3, 3e-2)
)
"""The noises of the filters that run side by side."""


class LostError(Exception):
    """An arc that does not reach the next track; its message is the reason."""


@dataclass(frozen=True)
class Leg:
    """An arc from one track's start to the next, and the transition of neighbouring arcs."""

    cd: float  # of the arc
    steps: np.ndarray  # (n,) lengths [s]
    path: np.ndarray  # (n + 1, 6) GCRF [m, m/s] at the ends of the steps
    transitions: np.ndarray  # (n, 6, 7) derivatives by the state before each step, and by Cd within it
    seen: np.ndarray  # (epochs, 6) states at the next track's epochs
    to_seen: np.ndarray  # (epochs, 6, 6) their derivatives by the state at the track's start

    @classmethod
    def propagate(
        cls, propagator: Propagator, parameters: np.ndarray, begin: float, seen: np.ndarray
    ) -> Self:
        """Return the leg from parameters (7,) at `begin` [s] to the epochs `seen` (n,) of the next track.

        It is propagated with what is known when that track begins. Raises LostError where it comes down
        before.
        """
        grid = np.linspace(begin, seen[0], math.ceil((seen[0] - begin) / STEP) + 1)
        known = propagator.under(propagator.model.known_at(float(seen[0])))
        states, status = propagate_neighbours(known, np.append(grid, seen[1:]), parameters)
        if status:
            raise LostError(REASONS[status])
        # By the parameters at the beginning, which a step keeps Cd of and moves the state.
        partials = ((states[1:] - states[0]) / NUDGES[:, None, None]).transpose(1, 2, 0)
        end = len(grid) - 1
        by_state = partials[:, :, :_CD]
        transitions = np.empty((end, 6, 7))
        transitions[:, :, :_CD] = _divided(by_state[1 : end + 1], by_state[:end])
        through = np.einsum("nij,nj->ni", transitions[:, :, :_CD], partials[:end, :, _CD])
        transitions[:, :, _CD] = partials[1 : end + 1, :, _CD] - through
        return cls(
            cd=float(parameters[_CD]),
            steps=np.diff(grid),
            path=states[0, : end + 1],
            transitions=transitions,
            seen=states[0, end:],
            to_seen=_divided(by_state[end:], by_state[end : end + 1]),
        )


def _divided(later: np.ndarray, earlier: np.ndarray) -> np.ndarray:
    """Return partial derivatives (n, 6, 6) by an earlier state, of two sets by one that is earlier still."""
    # later = divided earlier, solved transposed, in units that make positions and velocities comparable.
    unit = SCALES[:_CD] / SCALES[:_CD, None]
    turned = np.linalg.solve((earlier * unit).transpose(0, 2, 1), (later * unit).transpose(0, 2, 1))
    return turned.transpose(0, 2, 1) / unit


@dataclass(frozen=True)
class FilterState:
    """A state and Cd after the measurements of a track."""

    mean: np.ndarray  # (7,)
    root: np.ndarray  # (7, 7) of the covariance
    chi2: float  # of the innovations
    evidence: float  # their ln likelihood, but for a constant of the track
    passes: int  # how often the measurements were met


def meet(evaluate: Callable[[np.ndarray], Evaluation], mean: np.ndarray, root: np.ndarray) -> FilterState:
    """Return what measurements make of a mean (7,) and the root (7, 7) of its covariance.

    evaluate: residuals and partial derivatives at parameters (7,); called again where they bend
    """
    # Steps are taken in u, where parameters are mean + root u: what was known is a unit normal there, and no
    # eigenvalue of N is below 1, however near singular the covariance is. Each pass linearises again.
    u, passes, step = np.zeros(7), 0, np.inf
    while step > _CONVERGED and passes < _PASSES:
        evaluation = evaluate(mean + root @ u)
        partials = evaluation.jacobian @ root
        pulled = evaluation.residuals + partials @ u
        normal = np.eye(7) + partials.T @ partials
        before, u = u, np.linalg.solve(normal, partials.T @ pulled)
        step, passes = float(np.abs(u - before).max()), passes + 1
    low = np.linalg.cholesky(normal)
    chi2 = float(np.sum((pulled - partials @ u) ** 2) + u @ u)
    # ln det of the innovations' covariance, I + (J root)(J root)^T, is that of N: the sum of 2 ln diag(low).
    evidence = -0.5 * chi2 - float(np.sum(np.log(np.diag(low))))
    return FilterState(mean + root @ u, np.linalg.solve(low, root.T).T, chi2, evidence, passes)


@dataclass(frozen=True)
class Filters:
    """Filters of one bank at the start of a track."""

    t: float  # [s]
    meetings: Sequence[FilterState]  # of the last track, by filter
    scores: np.ndarray  # (filters,) ln likelihood of all innovations so far, but for a constant
    tracks: int  # number of those in the estimates
    measurements: int  # likewise

    @classmethod
    def begin(cls, estimate: pd.Series, size: int) -> Self:
        """Return a number of filters that begin at a row of `estimates`."""
        meeting = FilterState(
            estimate[PARAMETERS].to_numpy(float), covariance_root(_covariance(estimate)), np.nan, np.nan, 0
        )
        count, measurements = int(estimate["tracks_used"]), int(estimate["measurements_used"])
        return cls(float(estimate["t"]), [meeting] * size, np.zeros(size), count, measurements)

    @property
    def likeliest(self) -> FilterState:
        """That of the filter whose innovations were the likeliest so far."""
        return self.meetings[int(np.argmax(self.scores))]


@dataclass(frozen=True)
class Filtering:
    """All that the filters of a run share."""

    propagator: Propagator  # under the assumed model
    measured: Measurements
    bank: Sequence[Noise]  # a noise for each filter
    light_time: bool  # as in `Estimation`

    def next(self, filters: Filters, track: int) -> Filters:
        """Return the filters at the next track, with its measurements. Raises LostError."""
        window = self.measured.track(track)
        seen = self.measured.epochs[window.first : window.last + 1]
        leg = Leg.propagate(self.propagator, filters.likeliest.mean, filters.t, seen)

        def evaluate(parameters: np.ndarray) -> Evaluation:
            path = leg.seen + leg.to_seen @ (parameters[:_CD] - leg.path[-1])
            # Cd moves nothing while a track lasts.
            variations = np.zeros((7, *path.shape))
            variations[:_CD] = path + NUDGES[:_CD, None, None] * leg.to_seen.transpose(2, 0, 1)
            variations[_CD] = path
            states = np.concatenate([path[None], variations])
            return self.measured.evaluation(window, states, light_time=self.light_time)

        means = np.array([meeting.mean for meeting in filters.meetings])
        roots = np.array([meeting.root for meeting in filters.meetings])
        means, roots = self.propagated(means, roots, leg)
        meetings = [meet(evaluate, mean, root) for mean, root in zip(means, roots, strict=True)]
        return Filters(
            float(seen[0]),
            meetings,
            filters.scores + [meeting.evidence for meeting in meetings],
            filters.tracks + 1,
            filters.measurements + window.measurements,
        )

    def propagated(self, means: np.ndarray, roots: np.ndarray, leg: Leg) -> tuple[np.ndarray, np.ndarray]:
        """Return means (filters, 7) and roots of covariances (filters, 7, 7) at the end of a leg."""
        axes = rsw_rotation(leg.path)
        for k, step in enumerate(leg.steps):
            transition = np.vstack([leg.transitions[k], np.eye(7)[_CD]])
            deviations = (means - np.append(leg.path[k], leg.cd)) @ transition.T
            means = deviations + np.append(leg.path[k + 1], leg.cd)
            noise = self._noise(step / DAY, transition[:_CD, _CD], axes[k + 1, [0, 2]].T)
            # The triangle of a QR decomposition is a root of T P T' + Q: no variance is rounded below zero.
            wide = np.concatenate([transition @ roots, noise], axis=2)
            upper = np.asarray(np.linalg.qr(wide.transpose(0, 2, 1), mode="r"))
            roots = upper.transpose(0, 2, 1)
        return means, roots

    def _noise(self, days: float, by_cd: np.ndarray, aside: np.ndarray) -> np.ndarray:
        """Return the root (filters, 7, 4) of what a step [d] adds to the covariances.

        by_cd: (6,) change of the state per unit of Cd in the step
        aside: (3, 2) directions of the impulses
        """
        walk, gust, impulse = np.array([(noise.walk, noise.gust, noise.impulse) for noise in self.bank]).T
        cd, root = self.propagator.rso.cd, np.zeros((len(self.bank), 7, 4))
        root[:, _CD, 0] = walk * cd * np.sqrt(days)
        root[:, :_CD, 1] = np.outer(gust * cd / np.sqrt(days), by_cd)
        root[:, 3:_CD, 2:] = np.sqrt(days) * np.multiply.outer(impulse, aside)
        return root

    def row(self, filters: Filters, track: int) -> dict[str, Any]:
        """Return the estimate that the filters agree on as a row of the table."""
        meeting = filters.likeliest
        covariance = meeting.root @ meeting.root.T
        return {
            "track": track,
            "t": filters.t,
            **dict(zip(PARAMETERS, meeting.mean, strict=True)),
            **dict(zip(PARAMETER_COVARIANCES, covariance[np.tril_indices(7)], strict=True)),
            "iterations": meeting.passes,
            "converged": True,
            "reason": "",
            "tracks_used": filters.tracks,
            "measurements_used": filters.measurements,
            "weighted_rms": np.sqrt(meeting.chi2 / self.measured.count(self.measured.track(track).rows)),
        }


def _covariance(estimate: pd.Series) -> np.ndarray:
    return symmetric_matrices(estimate.to_frame().T, PARAMETER_COVARIANCES)[0]


def filter_all(
    propagator: Propagator,
    estimates: pd.DataFrame,
    measured: Measurements,
    *,
    light_time: bool = False,
    bank: Sequence[Noise] = BANK,
) -> pd.DataFrame:
    """Return the `estimates` table of the filters: one row per track, with all measurements up to its own.

    estimates: the table of batch fits of the same tracks, which the filters begin from
    light_time: as in `Estimation`
    bank: a noise for each filter

    Up to the first batch fit that they can begin at, and where an arc does not reach the next track, the row
    is that of the batch fit, as it is for tracks that are held back and those that show a burn, from which
    filters restart. weighted_rms is that of the innovations of the track.
    """
    run = Filtering(propagator.without_progress(), measured, bank, light_time)
    rows: list[dict[str, Any]] = []
    filters: Filters | None = None
    for track, (_, estimate) in enumerate(estimates.iterrows()):
        if estimate.get("held_back", False):
            rows.append(dict(estimate))
            continue
        begins_anew = np.isfinite(estimate.get("burn_t", np.nan))
        filters = _next_or_lost(run, filters, track) if filters and not begins_anew else None
        rows.append(dict(estimate) | (run.row(filters, track) if filters else {}))
        if filters is None:
            start = _with_apriori_cd(estimate, propagator.rso.cd)
            filters = Filters.begin(start, len(bank)) if start is not None else None
        if propagator.progress:
            propagator.progress((track + 1) / measured.tracks)
    return pd.DataFrame(rows)


def _next_or_lost(run: Filtering, filters: Filters, track: int) -> Filters | None:
    try:
        return run.next(filters, track)
    except LostError:
        return None


def _with_apriori_cd(estimate: pd.Series, cd: float) -> pd.Series | None:
    """Return a batch fit that takes the sheet's Cd for a measurement; None where no filter may begin."""
    if not estimate["converged"]:
        return None
    known = with_apriori_cd(estimate[PARAMETERS].to_numpy(float), _covariance(estimate), cd)
    if known is None:
        return None
    start = estimate.copy()
    start[PARAMETERS], covariance = known
    start[PARAMETER_COVARIANCES] = covariance[np.tril_indices(7)]
    return start
