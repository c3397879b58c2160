"""All schemas by their names, except those of trained models."""

from opml.tables.catalog_tables import CATALOG_SCHEMAS
from opml.tables.columns import Schema
from opml.tables.element_tables import ELEMENT_SCHEMAS
from opml.tables.environment_tables import ENVIRONMENT_SCHEMAS
from opml.tables.ephemeris_tables import EPHEMERIS_SCHEMAS
from opml.tables.learning_tables import LEARNING_SCHEMAS
from opml.tables.morning_tables import MORNING_SCHEMAS

_GROUPS = (
    *(ENVIRONMENT_SCHEMAS, CATALOG_SCHEMAS, LEARNING_SCHEMAS),
    *(EPHEMERIS_SCHEMAS, ELEMENT_SCHEMAS, MORNING_SCHEMAS),
)

SCHEMAS: dict[str, Schema] = {schema.name: schema for schemas in _GROUPS for schema in schemas}
