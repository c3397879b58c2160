"""Settings of orbit fits, and the facts of the fits of one job."""

from typing import Annotated

from annotated_types import Ge
from pydantic import Strict

from opml.base.section import Section, absent, setting
from opml.base.setting_types import Absent, Expected, Positive


class EstimationSettings(Section):
    """Fits of an orbit and a drag coefficient to tracks."""

    window_hours: Positive = setting("measurements before a track that its fit uses", unit="h")
    max_iterations: Annotated[int, Ge(1), Expected("a whole number from 1")] = setting(
        "iterations after which a fit counts as not converged"
    )
    convergence: Positive = setting("part of the formal uncertainty that a last step may still move")
    start_position_sigma_m: Positive = setting(
        "standard deviation by which the true position is perturbed where a first fit starts", unit="m"
    )
    start_velocity_sigma_mps: Positive = setting(
        "standard deviation by which the true velocity is perturbed where a first fit starts", unit="m/s"
    )
    least_drag_m: Positive = setting(
        "shift of a window's end per unit of Cd below which Cd is held at the RSO's own value", unit="m"
    )
    cd_sigma: Absent[Positive] = absent(
        "standard deviation of Cd about the RSO's own value, where that is known beforehand"
    )
    light_time: bool = setting(
        "whether fits read measurements as received when their light arrived; simulated ones are"
        " always geometric",
        see="physics.md#light-time",
        default=False,
    )
    reject_sigma: Absent[Positive] = absent(
        "residuals beyond so many standard deviations are outliers, left out by fits; by default none are"
    )
    bias_sigma: Absent[Positive] = absent(
        "standard deviation of a constant error of each station's observable, in a fit's window, in sigmas of"
        " its noise; by default there is none"
    )
    suspect_sigma: Absent[Positive] = absent(
        "tracks so many standard deviations from their prediction are held back from fits, and show burns;"
        " by default none are",
        see="tracks.md#burns",
    )


class Estimation(EstimationSettings):
    """Settings and prior knowledge of one job's fits."""

    cd_bounds: Annotated[tuple[float, float] | None, Strict(False)] = absent(
        "Cd of an estimate that others may start from; None where its formal uncertainty decides"
    )
