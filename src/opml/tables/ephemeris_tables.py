"""Schemas of the tables of ephemerides, and of the replay of earlier mornings."""

from opml.tables.columns import (
    PAIR,
    SINCE,
    SPREAD_COLUMNS,
    STATE,
    TIME,
    Schema,
    count,
    covariance,
    flag,
    real,
    state_columns,
    text,
)

DOUBT = [f"doubt_{axis}" for axis in "xyz"]
"""Columns of the standard deviation of the reference state that an ephemeris is compared with."""

SIGMA_STATE = [f"sigma_{name}" for name in STATE]
"""Columns of the standard deviations behind a covariance (`rsw_covariance.rsw_covariances`)."""

UNSEEN = ["unseen_x", "unseen_z"]
"""Columns of the part of these that errors against states that err alike do not show."""

_HELD_AGAINST = "RSW of the other"
_WAYS = {"r": "outwards", "s": "ahead along the track, as an arc", "w": "across"}

_KNOWN_STATE = "RSW of the state that it is compared with"

REPLAY_COLUMNS = (
    *PAIR,
    real("t_i", "s", f"epoch of the estimate, {SINCE}"),
    real("t_j", "s", f"epoch of the later track's start, {SINCE}"),
    real("t_known", "s", f"when the error was known, {SINCE}"),
    real("morning", "s", f"when what the ephemeris was made with was known, {SINCE}"),
    real("duration", "s", "prediction duration t_j - t_i"),
    real("rate", "rad/s", "rate at which the position turns"),
    real("before", "m", "along-track error of the prediction before correction", _KNOWN_STATE),
    *state_columns(_KNOWN_STATE, "error of the ephemeris at t_j", prefix="e_"),
    *(real(name, "m", "standard deviation of that state, 0 of a truth", _KNOWN_STATE) for name in DOUBT),
    *SPREAD_COLUMNS,
    *state_columns(
        "RSW of the ephemeris", "standard deviation stated that morning; NaN without a past", prefix="sigma_"
    ),
)

ALIKE = (flag("alike", "whether that state errs as the prediction does, as both are of mean elements"),)
"""Optional column of errors against later states."""

_UNSEEN = tuple(
    real(
        name, "m", "part of that deviation that no such state shows; only where they err alike", _KNOWN_STATE
    )
    for name in UNSEEN
)

_BURN_KNOWN = (
    real(
        "burn_known",
        "s",
        f"when a manoeuvre that the row crosses became known, {SINCE}; infinite without, optional",
    ),
)

EPHEMERIS_SCHEMAS = (
    Schema(
        "replay",
        "a pair of an estimate i and a later track start j",
        REPLAY_COLUMNS,
        (*ALIKE, *_UNSEEN, *_BURN_KNOWN),
    ),
    Schema(
        "corrected",
        "an epoch after an estimate",
        (
            count("i", "track of the estimate the ephemeris starts from"),
            real("t_i", "s", f"epoch of the estimate, {SINCE}"),
            TIME,
            *state_columns("GCRF", "corrected state"),
            *state_columns("GCRF", "predicted state, before correction", suffix="_predicted"),
            *covariance(STATE, "RSW of the corrected state"),
        ),
    ),
    Schema(
        "forecast",
        "an epoch after an estimate",
        (
            count("i", "track of the estimate the ephemeris starts from"),
            real("t_i", "s", f"epoch of the estimate, {SINCE}"),
            TIME,
            *state_columns("GCRF", "predicted state"),
            *covariance(STATE, "RSW of the predicted state"),
        ),
    ),
    Schema(
        "comparison",
        "a time at which one orbit is compared with another",
        (
            text("utc", "time, UTC"),
            real("hours", "h", "time since the first row"),
            *(
                real(axis, "m", f"one orbit less the other, {way}", _HELD_AGAINST)
                for axis, way in _WAYS.items()
            ),
            real("distance", "m", "distance of the two"),
            *(
                real(f"sigma_{axis}", "m", f"standard deviation of the first, {way}; NaN where unknown")
                for axis, way in _WAYS.items()
            ),
            real("ellipsoid", "1", "share of a normal distribution that is nearer by the first's covariance"),
        ),
    ),
)
