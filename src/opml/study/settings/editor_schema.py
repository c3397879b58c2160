"""The JSON schema by which editors complete and check settings."""

import json
from pathlib import Path
from typing import Any

from opml.base.files import FilePath, write_text
from opml.study.settings.json_schema import json_schema
from opml.study.settings.model.whole import SettingsFile

PLACE = Path("workflow/schemas/config.schema.json")
"""The file below a project's folder, as its settings name it."""

_ONLY_IN_TABLES = ("unit", "see", "shared", "placeholder")
"""Keys of a model's schema that documentation alone reads."""


def write(folder: FilePath) -> None:
    """Write the schema of a file of settings, whose mappings may all be incomplete, into a project."""
    path = Path(folder) / PLACE
    write_text(path, json.dumps(_described(json_schema(SettingsFile)), indent=1) + "\n")


def _described(node: Any) -> Any:
    """Return a schema whose descriptions have the units, without what only the tables read."""
    if isinstance(node, list):
        return [_described(item) for item in node]
    if not isinstance(node, dict):
        return node
    described = {key: _described(value) for key, value in node.items() if key not in _ONLY_IN_TABLES}
    if isinstance(unit := node.get("unit"), str):
        described["description"] += f" [{unit}]"
    return described
