"""Alarms that predictions with their covariances raise where two objects may collide.

A true approach may pass anywhere across the relative velocity, as often per area. So the alarms that are
raised per collision are the area of those expected misses whose probability reaches the threshold, in units
of the area in which objects collide; they depend on the covariance alone. In units of the area within a
kilometre they are those per approach as near, which screenings count. Of the approaches that are
collisions the share is flagged whose expected miss, the true one and both errors, raises an alarm.

Errors are those that predictions really had. The second object errs as some other prediction did, of the
same morning where that is told, its orbit crosses that of the first at an angle that is drawn, and its true
miss is drawn within the sum of the radii.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.optimize import brentq
from scipy.stats import qmc

from opml.base import seeds
from opml.base.constants import DAY
from opml.conjunctions.probability import integral, principal
from opml.learning.data.error_components import UNCORRECTED
from opml.learning.judge.model_choice import CHOSEN, Mornings
from opml.orbits.rsw_covariance import AXES
from opml.tables import ANY_CROSSING, SCHEMAS

FORMAL, LEARNED = "the fit's own", "of past errors"  # covariances that predictions go with
_DRAWS, _AREAS = 1024, 256  # collisions, and areas of alarms; powers of two balance Sobol's points
_HALF_DAY = 0.5 * DAY
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_ALONG = np.array([0.0, 1.0, 0.0])
_FARTHEST = 60.0  # standard deviations beyond which no alarm is raised

CROSSINGS = {ANY_CROSSING: (0, 180), "below 60": (0, 60), "60 to 120": (60, 120), "over 120": (120, 180)}
"""Angles at which the directions of two objects cross [deg]."""

NEAR = 1e3  # distance of approaches that screenings count [m]
BESIDE = ("sgp4", "fit96")
"""Models that are compared wherever a study has them: public elements, and four days of tracks as one fit."""


@dataclass(frozen=True)
class Screening:
    """How operators look at approaches."""

    radius: float  # sum of the radii of two objects [m]
    threshold: float  # probability from which on an alarm is raised


def compare(
    mornings: Mornings,
    fits: pd.DataFrame,
    screening: Screening,
    *,
    weather: str,
    laws: Sequence[str],
    days: Sequence[float],
    seed: int,
) -> pd.DataFrame:
    """Return the `conjunctions` table: uncorrected fits, BESIDE, the best without learning, what is selected.

    mornings: replayed
    fits: table `covariances` of the fits that are not corrected
    weather: that the predictions knew, in a word
    laws: models that learned
    days, seed: as in `alarms_by_day`
    """
    plain = mornings.tables[UNCORRECTED]
    best = mornings.best(name for name in mornings.tables if name not in laws)
    names = [name for name in BESIDE if name in mornings.tables and name != best]
    cases = [
        (UNCORRECTED, FORMAL, _with_covariances(plain, fits)),
        *((name, LEARNED, mornings.tables[name]) for name in (UNCORRECTED, *names, best)),
        (CHOSEN, LEARNED, mornings.selected),
    ]
    tables = [
        alarms_by_day(table, screening, days=days, seed=seed).assign(model=model, covariance=covariance)
        for model, covariance, table in cases
    ]
    return pd.concat(tables, ignore_index=True).assign(weather=weather)[SCHEMAS["conjunctions"].names]


def _with_covariances(replay: pd.DataFrame, fits: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of a `replay` table with the sizes that the fits' own covariances state."""
    known = replay[["i", "j"]].merge(fits, on=["i", "j"], how="left")
    sizes = {f"sigma_{axis}": np.sqrt(known[f"cov_{axis}_{axis}"].to_numpy()) for axis in AXES}
    return replay.assign(**sizes)


def alarms_by_day(
    replay: pd.DataFrame, screening: Screening, *, days: Sequence[float], seed: int
) -> pd.DataFrame:
    """Return what alarms the predictions of a `replay` table raise.

    days: durations, each with the predictions of half a day about it
    seed: of the draws

    Rows may have a `morning`, on which both objects err, and `common`: what one standard deviation of the
    density does along the track [m]. Columns: day; crossing: a key of CROSSINGS; flagged: share of the
    collisions that raise an alarm; alarms: those raised per collision; per_approach: those per approach
    within NEAR; predictions: how many there are. A duration without predictions that state a size has no row.
    """
    rows = []
    for day in days:
        about = (replay["duration"] - day * DAY).abs() < _HALF_DAY
        known = replay[about & np.isfinite(replay["sigma_x"])]
        if not known.empty:
            drawn = _drawn(known, screening, seeds.derive(seed, f"conjunctions {day:g}"))
            for crossing, (low, high) in CROSSINGS.items():
                own = drawn.loc[drawn["angle"].between(low, high), ["flagged", "alarms"]].mean()
                rows.append({"day": day, "crossing": crossing, "predictions": len(known), **own})
    table = pd.DataFrame(rows, columns=["day", "crossing", "predictions", "flagged", "alarms"])
    return table.assign(per_approach=table["alarms"] * (screening.radius / NEAR) ** 2)


def _drawn(known: pd.DataFrame, screening: Screening, rng: np.random.Generator) -> pd.DataFrame:
    """Return draws: `angle` of crossing [deg], `flagged`, and `alarms` per collision, NaN of most."""
    # Points of Sobol's are spread evenly over predictions in the order of their sizes.
    known = known.sort_values(["sigma_y", "sigma_x", "sigma_z"], kind="stable").reset_index(drop=True)
    errors = known[[f"e_{axis}" for axis in AXES]].to_numpy()
    variances = known[[f"sigma_{axis}" for axis in AXES]].to_numpy() ** 2
    known = known.assign(**{name: 0.0 for name in ("morning", "common") if name not in known})
    common, mornings = known["common"].to_numpy(), known["morning"].tolist()
    beside = known.groupby("morning").indices
    points = qmc.Sobol(5, seed=rng).random(_DRAWS)
    flagged, alarms = np.empty(_DRAWS), np.full(_DRAWS, np.nan)
    for k, point in enumerate(points.tolist()):
        one = int(point[0] * len(known))
        same = beside[mornings[one]]
        other = same[int(point[1] * len(same))]
        plane, turn = _crossing(2.0 * math.pi * point[2])
        shared = np.outer(common[one] * _ALONG, common[other] * (turn @ _ALONG))
        covariance = np.diag(variances[one]) + turn @ np.diag(variances[other]) @ turn.T - shared - shared.T
        off = plane @ (turn @ errors[other] - errors[one])
        away, angle = screening.radius * math.sqrt(point[3]), 2.0 * math.pi * point[4]
        miss = away * np.array([math.cos(angle), math.sin(angle)])
        along, sigmas = principal(miss + off, plane @ covariance @ plane.T, screening.radius)
        flagged[k] = integral(along, sigmas, screening.radius) >= screening.threshold
        if k < _AREAS:
            alarms[k] = _alarm_area(sigmas, screening) / (math.pi * screening.radius**2)
    angle = 180.0 - np.abs(180.0 - 360.0 * points[:, 2])
    return pd.DataFrame({"angle": angle, "flagged": flagged, "alarms": alarms})


def _crossing(angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the plane (2, 3) across the relative velocity, and the axes (3, 3) of the second object.

    angle: by which the second orbit is turned about the radius where they cross [rad]

    All in RSW of the first object.
    """
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    half = 0.5 * angle
    return np.array([[1.0, 0.0, 0.0], [0.0, math.cos(half), math.sin(half)]]), turn


def _alarm_area(sigmas: np.ndarray, screening: Screening) -> float:
    """Return the area [m2] of expected misses that raise an alarm, a quadrant of an oval four times."""
    unit = np.maximum(sigmas, 0.1 * screening.radius)

    def excess(distance: float, way: np.ndarray) -> float:
        return integral(distance * way * unit, sigmas, screening.radius) - screening.threshold

    area = 0.0
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        angle = 0.25 * math.pi * (1.0 + node)
        way = np.array([math.cos(angle), math.sin(angle)])
        if excess(0.0, way) > 0.0:
            reach = float(brentq(excess, 0.0, _FARTHEST, args=(way,), rtol=1e-3))
            area += 0.25 * math.pi * weight * 0.5 * reach**2
    return float(4.0 * area * unit[0] * unit[1])
