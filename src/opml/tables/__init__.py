"""Schemas of the tables between the workflow's stages, and the writer and readers of their Parquet files.

Every column carries its unit, frame and meaning as Parquet field metadata. SHA-256 digests cover all bytes
of a file, so that a reader notices damage. Learners declare the tables of trained models, in opml.learning.
"""

from opml.tables.catalog_tables import *
from opml.tables.columns import *
from opml.tables.element_tables import *
from opml.tables.environment_tables import *
from opml.tables.ephemeris_tables import *
from opml.tables.export import *
from opml.tables.learning_tables import *
from opml.tables.listing import *
from opml.tables.morning_tables import *
from opml.tables.parquet import *
from opml.tables.schemas import *
