"""Schemas of the tables that every morning leaves of an object."""

from collections.abc import Sequence
from dataclasses import replace

from opml.tables.catalog_tables import CATALOG_SCHEMAS
from opml.tables.columns import PREDICTED, SINCE, SPREAD_COLUMNS, Schema, count, real, state_columns, text
from opml.tables.ephemeris_tables import ALIKE, REPLAY_COLUMNS

SIZES = {
    **{f"constant_{axis}": ("m", f"constant, {axis}") for axis in "xyz"},
    **{f"rate_{axis}": ("m/s", f"growing with the duration, {axis}") for axis in "xyz"},
    **{f"drag_{axis}": ("1", f"in units of what a tenth more drag does, {axis}") for axis in "xyz"},
    **{f"velocity_{axis}": ("1", f"factor of the velocity's, {axis}") for axis in "xyz"},
    **{f"inflation_{k}": ("1", f"factor of the variances, at duration {k}") for k in range(5)},
}
"""Columns of the sizes of errors that an ephemeris was given, with unit and meaning."""

(_ESTIMATES,) = (schema for schema in CATALOG_SCHEMAS if schema.name == "estimates")

MORNING_SCHEMAS = (
    Schema(
        "kept_estimates",
        "a track and a window of its fit",
        (real("window_hours", "h", "measurements before the track that were fitted"), *_ESTIMATES.columns),
        _ESTIMATES.optional,
    ),
    Schema(
        "judged",
        "a model, an estimate i that a morning started from, and a later track start j",
        (text("model", "name of the model"), *REPLAY_COLUMNS),
        ALIKE,
    ),
    Schema(
        "issued",
        "a morning",
        (
            real("morning", "s", f"when it was, {SINCE}"),
            count("i", "track of the estimate that the ephemerides start from, -1 without any"),
            real("t_i", "s", f"epoch of that estimate, {SINCE}"),
            text("model", "the model that was used, empty if none"),
            text("verdict", "whether to trust the ephemeris: good, unproven, wide or do not use"),
            real("burn_t", "s", f"a burn that the morning found, {SINCE}; NaN without any"),
            *(real(name, unit, f"size of errors, {meaning}") for name, (unit, meaning) in SIZES.items()),
            real("days", "days", "length of the past that the sizes come from"),
            real("reach", "s", "longest prediction of that past"),
            real("flat", "s", "least duration that radial and cross-track sizes count, 0 but for sets"),
        ),
    ),
    Schema(
        "improved_numbers",
        "an object, of which a model improves the newest set on a morning",
        (
            text("model", "density or learned"),
            count("number", "of the catalogue"),
            real("t", "days", "epoch of the set, modified Julian day (UTC)"),
            real("motion", "rad/min", "its mean motion, improved"),
            real("bstar", "1/(6378.135 km)", "its B*, improved"),
        ),
    ),
)


def of_objects(schema: Schema) -> Schema:
    """Return the schema of a file with the rows of several objects, sorted by their names."""
    return replace(schema, columns=(text("object", "name of the object"), *schema.columns))


def paths_schema(models: Sequence[str]) -> Schema:
    """Return the schema of the table `paths`: ephemerides of models from the newest estimate of a morning."""
    return Schema(
        "paths",
        "an epoch after an estimate",
        (
            real("morning", "s", f"when it was made, {SINCE}"),
            count("i", "track of the estimate that the ephemerides start from"),
            real("t_i", "s", f"epoch of the estimate, {SINCE}"),
            real("t_j", "s", f"epoch of the ephemerides, {SINCE}"),
            *state_columns("GCRF", "predicted state"),
            *SPREAD_COLUMNS,
            *(
                real(f"e_y_{name}", "m", f"along-track error that {name} expects", PREDICTED)
                for name in models
            ),
        ),
    )
