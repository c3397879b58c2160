"""Schemas of the tables between the workflow's stages, and the writer and readers of their Parquet files.

Every column carries its unit, frame and meaning as Parquet field metadata. SHA-256 digests cover all bytes
of a file, so that a reader notices damage. Learners declare the tables of trained models, in opml.learning.
"""

from opml.tables.catalog_tables import (
    FIX_SIGMAS,
    MECHANISM_AXES,
    POSITION_COVARIANCES,
    SIGMAS,
    TRUTH_GROUPS,
    mechanism_schema,
)
from opml.tables.columns import (
    BURN,
    COMPONENTS,
    PARAMETER_COVARIANCES,
    PARAMETERS,
    SPREAD,
    STATE,
    STATE_COVARIANCES,
    Column,
    Schema,
    count,
    real,
    symmetric_matrices,
    text,
)
from opml.tables.element_tables import (
    ELEMENTS,
    IMPROVED_MODELS,
    catalogue_densities_schema,
    catalogue_rows_schema,
)
from opml.tables.environment_tables import (
    ENVIRONMENT,
    OPTIONAL,
    OUTLOOKS,
    THERMOSPHERE,
)
from opml.tables.ephemeris_tables import (
    DOUBT,
    SIGMA_STATE,
    UNSEEN,
)
from opml.tables.export import (
    check_suffix,
    write_as,
)
from opml.tables.learning_tables import (
    ELLIPSOID,
    LEARNING_VARIABLES,
    LEVELS,
    PLANE,
    WHOLE,
)
from opml.tables.listing import (
    HOW_TO_CSV,
    comma_separated,
    head,
    write_csv,
)
from opml.tables.morning_tables import (
    SIZES,
    of_objects,
    paths_schema,
)
from opml.tables.parquet import (
    read_kind,
    read_measured,
    read_metadata,
    read_runs,
    read_table,
    read_tables,
    write_table,
)
from opml.tables.schemas import SCHEMAS
