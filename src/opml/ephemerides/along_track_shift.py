"""A predicted orbit that is ahead or behind, brought to where it should be, position and velocity together.

Nearly all of a prediction's error lies along its path, e_y. So the correction follows the path instead of
its tangent: the orbit of a moment tau earlier, tau = asin(e_y / r) / w, with w the rate at which the position
turns. The radial error x by tau follows from the motion near a circular orbit without drag
(Clohessy & Wiltshire 1960, J. Aerospace Sci. 27; Vallado, ch. 6), in which y = r w tau:

    a slow drift         x = -2/3 r tau'      a higher orbit falls behind
    once per revolution  x = -1/2 r tau'      an eccentricity

Velocity is the derivative of that path. So e_vx = -w e_y holds, and the energy is that of an orbit which
drifts as the correction does. Cross-track nothing is changed but what follows from the time.
"""

from collections.abc import Callable

import numpy as np
from scipy.interpolate import make_interp_spline, make_lsq_spline

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.orbits.elements import rsw_rotation

LEAST_EPOCHS = 16  # epochs that a path needs for its derivatives

ROUGH = 1.0 / 60.0
"""Largest miss of a correction by the spline through every second of its values, in their time [m/s]."""

_SLOW = 3  # degree of the spline that a slow drift is
_FAST = 5
_PATH = 7  # so that a path sampled every minute is interpolated to a millimetre, up to its ends


def corrected(t: np.ndarray, states: np.ndarray, along_track: np.ndarray) -> np.ndarray:
    """Return corrected states (n, 6) GCRF [m, m/s] of one predicted path.

    t: (n,) ascending [s], every minute or so
    states: (n, 6) as predicted, GCRF [m, m/s]
    along_track: (n,) predicted less true position [m], the component e_y in RSW of the true state

    Raises InputError for fewer than LEAST_EPOCHS.
    """
    [found] = corrected_by_each(t, states, along_track[None])
    return np.asarray(found)


def corrected_by_each(
    t: np.ndarray, states: np.ndarray, along_track: np.ndarray, part: slice = slice(None)
) -> np.ndarray:
    """Return (k, n, 6) what `corrected` returns of one path by each of several corrections (k, n).

    part: epochs that are wanted, with some about them, as splines need them
    """
    if len(t) < LEAST_EPOCHS:
        raise InputError(f"ephemeris: expected at least {LEAST_EPOCHS} epochs to correct, got {len(t)}")
    radius = np.linalg.norm(states[:, :3], axis=1)
    rate = np.linalg.norm(np.cross(states[:, :3], states[:, 3:]), axis=1) / radius**2
    late = np.arcsin(np.clip(along_track / radius, -1.0, 1.0)) / rate
    radial = radial_part(t, late, radius, part)
    t, late, rate = t[part], late[:, part], rate[part]
    shifted = through(t, states[part])(t - late)
    shifted[..., 3:] *= 1.0 - _derivative(t, late)[..., None]
    axes = rsw_rotation(shifted.reshape(-1, 6)).reshape(*late.shape, 3, 3)
    shifted[..., :3] -= radial[..., None] * axes[..., 0, :]
    shifted[..., 3:] -= _derivative(t, radial)[..., None] * axes[..., 0, :]
    shifted[..., 3:] -= (radial * rate)[..., None] * axes[..., 1, :]
    return shifted


def through(t: np.ndarray, states: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Return the path through states (n, ...) at t (n,): a function of times that returns states."""
    return make_interp_spline(t, states, _PATH)


def radial_part(t: np.ndarray, late: np.ndarray, radius: np.ndarray, part: slice = slice(None)) -> np.ndarray:
    """Return the radial error [m] that goes with being `late` (..., n) [s] on an orbit of `radius` (n,) [m].

    part: epochs that are wanted, as of `corrected_by_each`

    What a cubic spline with a knot a day can follow is the slow drift, the rest a matter of revolutions.
    """
    days = max(1, round((t[-1] - t[0]) / DAY))
    inner = np.linspace(t[0], t[-1], days + 1)
    knots = np.concatenate([np.repeat(t[0], _SLOW), inner, np.repeat(t[-1], _SLOW)])
    drift = make_lsq_spline(t, np.moveaxis(late, -1, 0), knots, _SLOW).derivative()(t[part])
    drift = np.moveaxis(drift, 0, -1)
    return -radius[part] * (2.0 / 3.0 * drift + 0.5 * (_derivative(t[part], late[..., part]) - drift))


def _derivative(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the derivative (..., n) of values (..., n) at t (n,)."""
    return make_interp_spline(t, values, _FAST, axis=-1).derivative()(t)


def check_smooth(t: np.ndarray, along_track: np.ndarray) -> None:
    """Raise InputError for a correction (n,) [m] at t (n,) [s] that has steps, and so no velocity."""
    off = np.abs(make_interp_spline(t[::2], along_track[::2], _FAST)(t) - along_track)
    # Near its ends a spline is off what is smooth, too.
    step = float(off[_FAST + 1 : -_FAST - 1].max())
    if step > ROUGH * float(np.median(np.diff(t))):
        raise InputError(
            "ephemeris: expected a correction that is smooth in time, got fits over several windows that "
            f"differ too fast: one with steps of {step:.3g} m"
        )
