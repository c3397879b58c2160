"""Schemas of the tables from the truth to predictions and their labels."""

from collections.abc import Sequence

from opml.tables.columns import (
    BURN,
    COMPONENTS,
    ERRORS,
    NO_TRUTH,
    PAIR,
    PARAMETERS,
    PREDICTED,
    SINCE,
    SPREAD_COLUMNS,
    TIME,
    Schema,
    count,
    covariance,
    covariance_names,
    flag,
    real,
    state_columns,
    text,
)
from opml.tables.element_tables import IMPROVED_MODELS

TRUTH_GROUPS = "truth_groups"  # kind of the tables that list the RSOs whose truths one job made

POSITION_COVARIANCES = covariance_names("xyz")
"""Columns of the lower triangle, row by row, of a position's covariance."""

SIGMAS = [f"sigma_{name}" for name in COMPONENTS]  # columns of a label's uncertainty, by error component

MECHANISM_AXES = (
    *("s", "v", "r", "l", "v_long", "floor", "l_arc", "v_arc", "h_arc", "sgp4"),
    *IMPROVED_MODELS,
)
"""Prefixes of the mechanism's columns for each error component, such as `v_y` for e_y."""

FIX_SIGMAS = [f"sigma_{axis}" for axis in ("r", "s", "w", "vr", "vs", "vw")]
"""Columns of the standard deviations of a point's position and velocity, in RSW."""

_HELD_AGAINST = "RSW of the later estimate at t_j"

LABEL_COLUMNS = state_columns(_HELD_AGAINST, "predicted state minus later estimate at t_j", prefix="e_")

LABELLED = (
    *state_columns(_HELD_AGAINST, "formal standard deviation of the estimate at t_j", prefix="sigma_e_"),
    real("t_known", "s", f"end of the last track that the later estimate is made of, {SINCE}"),
)

_SENSITIVITIES = (
    real("cd_mean", "1", "running mean of the drag coefficients estimated up to t_i"),
    *state_columns(PREDICTED, "change of the prediction per unit of Cd, state at t_i held", prefix="s_"),
    *state_columns(
        PREDICTED, "change per unit of Cd, state at t_i moved with Cd along the fit's covariance", prefix="v_"
    ),
    *state_columns(PREDICTED, "prediction minus the one repeated with cd_mean", prefix="r_"),
)

_MECHANISM = (
    real("cd", "1", "drag coefficient estimated at t_i"),
    *_SENSITIVITIES,
    real("cd_long", "1", "drag coefficient of the long arc that ends at t_i"),
    real("d_cd_long", "1", "cd_long minus the running mean of the long arcs' drag coefficients"),
    *state_columns(PREDICTED, "prediction minus the one from the long arc", prefix="l_"),
    *state_columns(PREDICTED, "as v, for the prediction from the long arc", prefix="v_long_"),
)

_ARCS = (
    real("cd_arc", "1", "drag coefficient of the arc that ends at t_i, or the sheet's where undetermined"),
    *state_columns(PREDICTED, "prediction minus that of the arc", prefix="l_arc_"),
    *state_columns(
        PREDICTED, "change of the arc's prediction per unit of Cd along its covariance", prefix="v_arc_"
    ),
)

_CD_PAST = (
    real(
        "cd_past", "1", "mean of the arcs' drag coefficients up to t_i, weighted by 1/variance, with memory"
    ),
)

_HELD = state_columns(PREDICTED, "prediction minus that of the arc with Cd held by its past", prefix="h_arc_")

_SGP4 = state_columns(PREDICTED, "prediction minus that of SGP4 from the newest set at t_i", prefix="sgp4_")

_IMPROVED = tuple(
    column
    for model in IMPROVED_MODELS
    for column in state_columns(
        PREDICTED,
        f"prediction minus that of SGP4 from the newest set at t_i, improved by `{model}`",
        prefix=f"{model}_",
    )
)


def mechanism_schema(resonances: Sequence[tuple[int, int]]) -> Schema:
    """Return the schema of the table `mechanism` with two columns for each resonance (k, m)."""
    meaning = "along-track drift per unit of an acceleration as the {part} of {k} (w + M) + {m} (W - theta)"
    drifts = tuple(
        real(f"{name}_{k}_{m}", "s2", meaning.format(part=part, k=k, m=m))
        for k, m in resonances
        for name, part in (("cos", "cosine"), ("sin", "sine"))
    )
    row = "a pair of an estimate i and a later track start j"
    return Schema("mechanism", row, (*PAIR, *_MECHANISM, *drifts))


_IF_MEASURED = "; only where a station has it"

_OBSERVABLES = (
    real("range_rate", "m/s", f"measured rate of the range{_IF_MEASURED}", "topocentric"),
    real("right_ascension", "rad", f"measured right ascension, from the station{_IF_MEASURED}", "GCRF"),
    real("declination", "rad", f"measured declination, from the station{_IF_MEASURED}", "GCRF"),
    real("range_rate_true", "m/s", f"rate of the range without noise{_IF_MEASURED}", "topocentric"),
    real("right_ascension_true", "rad", f"right ascension without noise{_IF_MEASURED}", "GCRF"),
    real("declination_true", "rad", f"declination without noise{_IF_MEASURED}", "GCRF"),
    flag("two_way", "whether range and rate are half of those there and back; only where there are any"),
)
"""Columns of the table `tracking` for what few stations measure."""


CATALOG_SCHEMAS = (
    Schema("truth", "an epoch of the tracking grid", (TIME, *state_columns("GCRF", "true state"))),
    Schema(TRUTH_GROUPS, "an RSO of those whose truths one job made", (text("rso", "name"),)),
    Schema(
        "tracking",
        f"a measurement by one station{NO_TRUTH}, or no measurement",
        (
            count("track", "number of the track, from 0"),
            TIME,
            text("station", "station"),
            real("azimuth", "rad", "measured azimuth, from north eastwards", "topocentric"),
            real("elevation", "rad", "measured elevation", "topocentric"),
            real("range", "m", "measured range", "topocentric"),
            real("azimuth_true", "rad", "azimuth without noise, from north eastwards", "topocentric"),
            real("elevation_true", "rad", "elevation without noise", "topocentric"),
            real("range_true", "m", "range without noise", "topocentric"),
        ),
        _OBSERVABLES,
    ),
    Schema(
        "laser_ranges",
        "a normal point of laser ranging, in the place of `tracking`",
        (
            count("track", "number of the pass, from 0"),
            real("t", "s", f"when the light was received, {SINCE}"),
            text("station", "number of the station"),
            real("range", "m", "half of the light's way there and back, to the satellite's centre of mass"),
            real("sigma_range", "m", "standard deviation of the range"),
            *(
                real(f"{axis}_station", "m", f"where the station was then, with its tide, {axis}", "ITRF")
                for axis in "xyz"
            ),
            real("zenith_delay", "m", "delay by the air above the station, one way"),
            real("temperature", "K", "of the air"),
        ),
    ),
    Schema(
        "fixes",
        "a point of an orbit that was measured, in the place of `tracking`",
        (
            count("track", "number of the track, from 0"),
            TIME,
            *state_columns("GCRF", "measured state, velocities NaN where unknown"),
            *(
                real(
                    name,
                    "m" if len(name) == len(FIX_SIGMAS[0]) else "m/s",
                    "standard deviation of that state, NaN where velocities do not count",
                    "RSW",
                )
                for name in FIX_SIGMAS
            ),
            real("t_estimate", "s", f"epoch of the track's estimate, {SINCE}"),
            real("t_known", "s", f"when the point was known, {SINCE}"),
        ),
    ),
    Schema(
        "starts",
        "a track that was measured",
        (
            count("track", "number of the track"),
            real("t", "s", f"start of the track, {SINCE}"),
            *state_columns("GCRF", "first orbit at the track's start, NaN where it does not last"),
            real("age", "s", "time from the known orbit's epoch to the track's start"),
        ),
    ),
    Schema(
        "estimates",
        "a track",
        (
            count("track", "number of the track"),
            real("t", "s", f"start of the track, {SINCE}"),
            *state_columns("GCRF", "estimated state at the track's start"),
            real("cd", "1", "estimated drag coefficient"),
            *covariance(PARAMETERS, "GCRF"),
            count("iterations", "iterations of the least squares"),
            flag("converged", "whether the least squares converged"),
            text("reason", "why there is no usable estimate, empty where there is one"),
            count("tracks_used", "tracks within the estimation window"),
            count("measurements_used", "measurements within the estimation window"),
            real("weighted_rms", "1", "root mean square of the weighted residuals"),
        ),
        (
            count("rejected", "measured numbers in the window that are outliers; only where any are judged"),
            count("rejected_of_track", "those of the track itself"),
            flag("held_back", "whether no known orbit explains the track; only where `suspect_sigma` is set"),
            count("tracks_left_out", "tracks within the window that are held back, or before a burn"),
            real("burn_t", "s", f"time of the burn that this track showed, NaN for none, {SINCE}"),
            *(
                real(
                    name,
                    "m/s",
                    f"change of velocity by that burn, {axis}, NaN where no single one explains it",
                    "RSW",
                )
                for name, axis in zip(BURN[1:], ("radial", "along-track", "cross-track"), strict=True)
            ),
        ),
    ),
    Schema(
        "predictions",
        f"a pair of an estimate i and a later track start j{NO_TRUTH}",
        (
            *PAIR,
            real("t_i", "s", f"epoch of the estimate, {SINCE}"),
            real("t_j", "s", f"epoch predicted to, {SINCE}"),
            *state_columns("GCRF", "predicted state at t_j"),
            *state_columns("GCRF", "true state at t_j", suffix="_true"),
            *ERRORS,
            text("reason", "why there is no prediction (state and errors are NaN then), else empty"),
        ),
    ),
    Schema(
        "labels",
        "a pair of an estimate i and a later track start j",
        (
            *PAIR,
            *LABEL_COLUMNS,
            *LABELLED,
            text("reason", "why there is no label (its numbers are NaN then), else empty"),
        ),
    ),
    Schema("sensitivities", "a pair of an estimate i and a later track start j", (*PAIR, *_SENSITIVITIES)),
    Schema(
        "oracle",
        "a pair of an estimate i and a later track start j",
        (
            *PAIR,
            real("drift", "m", "along-track error due to the error of the estimate's semi-major axis"),
            *state_columns(
                "RSW of the true state at t_j",
                "error of the prediction from the true state and Cd at t_i",
                prefix="floor_",
            ),
        ),
    ),
    mechanism_schema(((1, 15), (1, 16), (2, 31))),
    Schema(
        "covariances",
        "a pair of an estimate i and a later track start j",
        (
            *PAIR,
            *(
                real(
                    name,
                    "m m",
                    "covariance of the fit at t_i, carried to t_j: "
                    + " and ".join(name.removeprefix("cov_").split("_")),
                    PREDICTED,
                )
                for name in POSITION_COVARIANCES
            ),
        ),
    ),
    Schema("arcs", "a pair of an estimate i and a later track start j", (*PAIR, *_ARCS)),
    Schema("cd_past", "a pair of an estimate i and a later track start j", (*PAIR, *_CD_PAST)),
    Schema("held", "a pair of an estimate i and a later track start j", (*PAIR, *_HELD)),
    Schema("sgp4", "a pair of an estimate i and a later track start j", (*PAIR, *_SGP4)),
    Schema("improved", "a pair of an estimate i and a later track start j", (*PAIR, *_IMPROVED)),
    Schema(
        "ensemble",
        "a pair of the predictions, and a future",
        (
            *PAIR,
            count("member", "number of the future"),
            *(
                real(f"d_{axis}", "m", f"prediction under the future minus the prediction, {axis}", PREDICTED)
                for axis in "xyz"
            ),
        ),
    ),
    Schema(
        "fan",
        "a pair of the predictions",
        (
            *PAIR,
            real("duration", "s", "prediction duration t_j - t_i"),
            real("e_y", "m", "true along-track error of the prediction", "RSW of the true state at t_j"),
            real("mean", "m", "mean of what the futures say of that error", PREDICTED),
            real("sigma", "m", "their standard deviation", PREDICTED),
            real("low", "m", "their lower quantile, at (1 - level) / 2", PREDICTED),
            real("median", "m", "their median", PREDICTED),
            real("high", "m", "their upper quantile", PREDICTED),
            real("crps", "m", "continuous ranked probability score of the futures"),
        ),
    ),
    Schema(
        "scores",
        "a day of prediction durations, of the fans",
        (
            count("day", "prediction durations up to this number of days, above that of the day before"),
            count("rows", "predictions"),
            real("inside", "1", "share of the errors from low to high"),
            real("width", "m", "mean distance from low to high"),
            real("crps", "m", "mean continuous ranked probability score"),
            real("error", "m", "mean absolute along-track error of the prediction itself"),
        ),
    ),
    Schema("spread", "a pair of an estimate i and a later track start j", (*PAIR, *SPREAD_COLUMNS)),
)
