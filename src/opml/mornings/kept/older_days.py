"""Days of older versions, a folder of each object with tables of it alone, turned into those of a batch."""

import json
from pathlib import Path

from opml.base.files import FilePath
from opml.mornings import outcomes
from opml.mornings.kept.batch_day import PATHS, BatchDay, FinishedMorning
from opml.mornings.records import Paths, Records
from opml.tables import paths_schema, read_metadata, read_table

_DONE = "morning.json"
_BATCH = "batch_of_folders"


def convert(days: FilePath) -> None:
    """Turn the folders of objects of all days into a batch a day; messages stay where they are.

    Raises InputError where a table is missing or damaged. What is converted goes when the batch is whole.
    """
    folders: dict[Path, list[Path]] = {}
    for path in sorted(Path(days).glob(f"[0-9]*-*-*/*/{_DONE}")):
        folders.setdefault(path.parent.parent, []).append(path.parent)
    for day, objects in folders.items():
        place = BatchDay(day / _BATCH)
        if made := {one.name: _finished(one) for one in objects if one.name not in place.marks}:
            place.write(made, metadata=read_metadata(objects[0] / "issued.parquet"))
        for path in (path for one in objects for path in [*one.glob("*.parquet"), one / _DONE]):
            path.unlink()


def _finished(folder: Path) -> FinishedMorning:
    made, paths = read_metadata(folder / "issued.parquet"), folder / PATHS
    estimates, judged, issued = (read_table(folder / f"{name}.parquet", name) for name in Records.TABLES)
    ephemerides = (
        [Paths(read_table(paths, paths_schema(read_metadata(paths)["models"])))] if paths.exists() else []
    )
    records = Records(estimates, judged, issued, ephemerides)
    outcome = outcomes.NOTHING | json.loads((folder / _DONE).read_text(encoding="utf-8"))
    return FinishedMorning(records, outcome, made["settings"], made.get("stations", {}))
