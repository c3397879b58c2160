"""Tables tell the settings that made them, and the plan believes them.

Snakemake compares the settings of a job with its own record of each file, kept by the file's path. A folder
of results that was moved, copied or mixed from two runs has no such record, or that of another file. Every
table of opml holds a digest of the settings that made it, wherever it goes.
"""

from pathlib import Path
from typing import Any

from snakemake.persistence import ParamsChange, PersistenceBase

from opml.base.errors import InputError
from opml.base.provenance import settings_digest, settings_of_each
from opml.tables import read_metadata


def compare_tables_with_settings() -> None:
    """Make Snakemake's plan take a table for changed where other settings made it than those of its job."""
    known, changed = PersistenceBase.has_metadata, PersistenceBase.params_changed

    def has_metadata(self: Any, job: Any) -> bool:
        return known(self, job) or bool(tables_of_other_settings(job))

    def params_changed(self: Any, job: Any, file: Any = None) -> Any:
        changes = changed(self, job, file=file)
        tables = tables_of_other_settings(job)
        return changes | ParamsChange({"settings in the table"}, set(), tables) if tables else changes

    PersistenceBase.has_metadata = has_metadata
    PersistenceBase.params_changed = params_changed


def tables_of_other_settings(job: Any) -> set[str]:
    """Return the tables among the outputs of a job that exist and were made with other settings.

    A table that is damaged counts as one of them.
    """
    settings = job.params.get("settings")
    paths = [path for path in map(str, job.output) if path.endswith(".parquet") and Path(path).exists()]
    if settings is None or not paths:
        return set()
    digests = {settings_digest(settings), *map(settings_digest, settings_of_each(settings))}
    return {path for path in paths if _digest_of(path) not in digests}


def _digest_of(path: str) -> str | None:
    try:
        digest: str | None = read_metadata(path).get("settings")
    except InputError:
        return None
    return digest
