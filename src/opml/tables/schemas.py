"""All schemas by their names, except those of trained models."""

from opml.tables.catalog_tables import CATALOG_SCHEMAS
from opml.tables.columns import Schema
from opml.tables.environment_tables import ENVIRONMENT_SCHEMAS
from opml.tables.ephemeris_tables import EPHEMERIS_SCHEMAS
from opml.tables.learning_tables import LEARNING_SCHEMAS

SCHEMAS: dict[str, Schema] = {
    schema.name: schema
    for schema in (*ENVIRONMENT_SCHEMAS, *CATALOG_SCHEMAS, *LEARNING_SCHEMAS, *EPHEMERIS_SCHEMAS)
}
