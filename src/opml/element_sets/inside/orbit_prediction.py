"""The orbit inside an object's sets from a date on, its position along the track as the corrector learned."""

from collections.abc import Callable, MutableMapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.element_sets.improve import Improved
from opml.element_sets.improved_sizes import ExpectedErrors
from opml.element_sets.inside import inside_now, inside_sizes
from opml.element_sets.inside.inside_forces import Forces
from opml.element_sets.inside.inside_now import InsideNow
from opml.element_sets.inside.inside_sizes import lower
from opml.element_sets.inside.orbit_inside import NoOrbitError
from opml.element_sets.inside.past_orbits import Calibration
from opml.element_sets.set_errors import OLDEST
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.element_set import LOW, decay, mean_height
from opml.interop.predicted_orbit import LEADS
from opml.orbits.state_polynomials import StatePolynomials

OWN_PART = {1: 0.2, 3: 0.1, 5: 0.1, 7: 0.2}
"""Part of its own position along the track that the orbit inside keeps against the learned one, by lead [d].

Chosen on eight mornings of spring 2026, with a corrector trained before them on other objects and years.
"""
FORECAST = 3.0  # lead from which the density of the days ahead decides, wherever drag is felt [d]
NEAR = 0.75  # days by which an error of the past may be off a lead


@dataclass(frozen=True, eq=False)
class OrbitInside:
    """The orbit inside an object's sets from a date on.

    path: function of times [s since the date] that returns GCRF states; now: as it was sought; rms: of its
    errors, as of `inside_sizes.rms`; is_corrected: whether its along-track position is as learned
    """

    path: Callable[[np.ndarray], np.ndarray]
    now: InsideNow
    rms: pd.DataFrame
    is_corrected: bool

    @property
    def reason(self) -> str:
        """Why it is trusted: how far the orbits of past sets agree, in words."""
        known = self.now.calibration
        side = "on both sides of" if known.span.is_centred else "before"
        fits = f"fits over {known.span.before / HOUR:g} h {side} its sets"
        if not known.is_told:
            return f"{fits}, as is usual; too few sets to compare spans"
        return f"{fits} agree to {known.r:.0f} m outwards and {known.w:.0f} m across"

    def errors(self, improved: ExpectedErrors, storm: float) -> ExpectedErrors:
        """Return its expected errors.

        improved: those of the improved set; storm: by how much a storm of the last days widens
        """
        sizes, others = inside_sizes.sizes(self.now, self.rms), improved.sizes
        sizes["s"] *= storm
        newest = self.now.orbit.beginning.satellite
        if self.is_corrected:
            sizes["s"] = np.minimum(sizes["s"], others["s"])
        elif newest.bstar <= 0.0 and mean_height(newest.no_kozai) < LOW:  # what drag there is, nothing tells
            sizes["s"] = np.fmax(sizes["s"], others["s"])
        sizes["r"] = np.hypot(sizes["r"], lower(sizes["s"], newest.no_kozai))
        # Beyond the leads that SGP4's own errors tell they grow as those of the improved set.
        part = (sizes["sgp4"] / others["sgp4"]).ffill().fillna(1.0)
        sizes["sgp4"] = sizes["sgp4"].fillna(part * others["sgp4"])
        pairs = self.now.calibration.errors
        own = f"{len(pairs)} pairs of its sets of the last {inside_now.PAST:g} days, against "
        basis = (
            f"by {own if len(pairs) else ''}typical errors of orbits that decay as fast, "
            "and what all sets have in common; "
            "along the track the corrector's sigma where it is smaller"
        )
        return ExpectedErrors(sizes, past_errors(pairs), basis)


def past_errors(errors: pd.DataFrame) -> pd.DataFrame:
    """Return by lead what SGP4 (`error`) and the orbits of past sets (`left`) were off along the track [m].

    errors: by the orbits of later sets, means of a revolution, as of `PastOrbits.errors`
    """
    leads = np.array(LEADS[1:])
    nearest = np.abs(errors["days"].to_numpy()[:, None] - leads).argmin(axis=1)
    rows = errors.assign(lead=leads[nearest], error=errors["sgp4_ahead"], left=errors["ahead"])
    return rows.loc[np.abs(rows["days"] - rows["lead"]) <= NEAR, ["lead", "error", "left"]].dropna()


def predict(
    public: Sequence[KnownSet],
    number: int,
    better: Improved,
    *,
    days: float,
    forces: Callable[[], Forces],
    kept: MutableMapping[str, Calibration],
) -> OrbitInside | str:
    """Return the orbit inside the sets of an object, or why there is none, in words.

    public: sets of the object that were known on the date of `better`, none from before its last burn, by
        epoch; times since it
    number: of the object in `better`, whose corrections shift the orbit along its track
    forces: returns those of `inside_now.forces_on` the date; kept: as of `inside_now.find`
    """
    newest = public[-1]
    if newest.t < -DAY * OLDEST:
        return f"newest set older than {OLDEST:g} d"
    if reason := inside_now.unsuited(newest.satellite):
        return reason
    try:
        now = inside_now.find(public, date=better.date, forces=forces(), kept=kept)
    except NoOrbitError as reason:
        return str(reason)
    if doubt := inside_now.doubt(now.calibration, now.orbit.beginning.satellite, better.date):
        return doubt
    rows = better.corrections[better.corrections["number"] == number]
    is_corrected = len(rows) == len(LEADS) - 1
    rms = inside_sizes.rms(now)
    shift = _shift(now, rms, rows) if is_corrected else None
    return OrbitInside(StatePolynomials(*now.predict(days, shift)).at, now, rms, is_corrected)


def _shift(now: InsideNow, rms: pd.DataFrame, corrections: pd.DataFrame) -> np.ndarray:
    """Return by what the orbit is to be ahead of where it goes by itself, as `InsideNow.predict` takes it.

    The corrected position of SGP4 along the track counts against its own, where drag is small by the inverse
    of their variances. At the date the orbit stays where it is.
    """
    leads = np.array(LEADS, float)
    own = np.hypot(rms["s"].to_numpy(), inside_sizes.FLOOR["s"])
    sigma = np.append(own[0], corrections["sigma"])
    part = own**2 / (own**2 + sigma**2)
    sinking = decay(now.orbit.beginning.satellite)
    if sinking >= inside_now.STEADY:
        is_chosen = (leads >= FORECAST) | (sinking >= inside_now.LITTLE_DRAG)
        part = np.where(is_chosen, 1.0 - np.interp(leads, [*OWN_PART], [*OWN_PART.values()]), part)
    part[0] = 0.0
    ahead = now.ahead_of_sgp4(leads) - np.append(0.0, corrections["correction"])
    return np.column_stack([leads, part * ahead, np.minimum(own, sigma)])
