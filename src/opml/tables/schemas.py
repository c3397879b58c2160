"""All schemas by their names, except those of trained models."""

from opml.tables.catalog_tables import CATALOG_SCHEMAS
from opml.tables.columns import Schema
from opml.tables.element_tables import ELEMENT_SCHEMAS
from opml.tables.environment_tables import ENVIRONMENT_SCHEMAS
from opml.tables.ephemeris_tables import EPHEMERIS_SCHEMAS
from opml.tables.learning_tables import LEARNING_SCHEMAS
from opml.tables.morning_tables import MORNING_SCHEMAS

STAGES = {
    "environment": ENVIRONMENT_SCHEMAS,
    "catalogue": CATALOG_SCHEMAS,
    "learning": LEARNING_SCHEMAS,
    "ephemerides": EPHEMERIS_SCHEMAS,
    "element sets": ELEMENT_SCHEMAS,
    "mornings": MORNING_SCHEMAS,
}
"""Schemas by the stage of the workflow that makes the tables."""

SCHEMAS: dict[str, Schema] = {schema.name: schema for schemas in STAGES.values() for schema in schemas}
