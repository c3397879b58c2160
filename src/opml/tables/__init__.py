"""The tables that pass from stage to stage: their columns, and how they are written to and read from Parquet.

Every column carries its unit, frame and meaning as Parquet field metadata. Pages carry checksums and the
footer a SHA-256 digest of its own text, so that a damaged file is noticed by its reader. The tables of
trained models are declared by their learners, in opml.learning.
"""

from opml.tables.catalog_tables import (
    MECHANISM_AXES,
    POSITION_COVARIANCES,
    SIGMAS,
    TRUTH_GROUPS,
    mechanism_schema,
)
from opml.tables.columns import (
    COMPONENTS,
    PARAMETER_COVARIANCES,
    PARAMETERS,
    SPREAD,
    STATE,
    STATE_COVARIANCES,
    Column,
    Schema,
    count,
    flag,
    real,
    symmetric,
    text,
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
)
from opml.tables.learning_tables import (
    ELLIPSOID,
    LEARNING_COLUMNS,
    LEARNING_VARIABLES,
    LEVELS,
    PLANE,
    WHOLE,
)
from opml.tables.page import (
    markdown,
)
from opml.tables.parquet import (
    read_kind,
    read_metadata,
    read_table,
    read_tables,
    write_table,
)
from opml.tables.schemas import SCHEMAS

__all__ = [
    "COMPONENTS",
    "DOUBT",
    "ELLIPSOID",
    "ENVIRONMENT",
    "LEARNING_COLUMNS",
    "LEARNING_VARIABLES",
    "LEVELS",
    "MECHANISM_AXES",
    "OPTIONAL",
    "OUTLOOKS",
    "PARAMETERS",
    "PARAMETER_COVARIANCES",
    "PLANE",
    "POSITION_COVARIANCES",
    "SCHEMAS",
    "SIGMAS",
    "SIGMA_STATE",
    "SPREAD",
    "STATE",
    "STATE_COVARIANCES",
    "THERMOSPHERE",
    "TRUTH_GROUPS",
    "WHOLE",
    "Column",
    "Schema",
    "count",
    "flag",
    "markdown",
    "mechanism_schema",
    "read_kind",
    "read_metadata",
    "read_table",
    "read_tables",
    "real",
    "symmetric",
    "text",
    "write_table",
]
