"""Schemas of the tables between the workflow's stages, and the writer and readers of their Parquet files.

`opml/data/tables.yaml` lists tables and columns. Every column carries its unit, frame and meaning as Parquet
field metadata. SHA-256 digests cover all bytes of a file, so that a reader notices damage. Learners declare
the tables of trained models, in opml.learning.
"""

from opml.tables.columns import *
from opml.tables.export import *
from opml.tables.listing import *
from opml.tables.parquet import *
from opml.tables.schemas import *
