"""Days of older releases: a folder of each object, with tables of it alone."""

import json
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from opml.mornings import outcomes
from opml.mornings.kept.batch_day import PATHS, Mark
from opml.mornings.records import Paths
from opml.tables import paths_schema, read_metadata, read_table

_DONE = "morning.json"


class ObjectDay:
    """The folder of an object on a day, as a `BatchDay` of one object."""

    def __init__(self, folder: Path) -> None:
        """Take the folder, which need not be there."""
        self.folder = folder

    @property
    def is_over(self) -> bool:
        """Whether the morning is over."""
        return (self.folder / _DONE).exists()

    @cached_property
    def marks(self) -> dict[str, Mark]:
        """How the morning was made."""
        made = read_metadata(self.folder / "issued.parquet")
        return {self.folder.name: Mark(made["settings"], made.get("stations", {}), [], [])}

    @cached_property
    def outcomes(self) -> dict[str, dict[str, Any]]:
        """What became of the object."""
        text = (self.folder / _DONE).read_text(encoding="utf-8")
        return {self.folder.name: outcomes.whole(json.loads(text))}

    def rows(self, table: str, _: str) -> pd.DataFrame:
        """Return a table. Raises InputError where it is missing or damaged."""
        return read_table(self.folder / f"{table}.parquet", table)

    def paths(self, _: str) -> list[Paths]:
        """Return the ephemerides, if the morning made any."""
        file = self.folder / PATHS
        return [Paths(read_table(file, paths_schema(read_metadata(file)["models"])))] if file.exists() else []
