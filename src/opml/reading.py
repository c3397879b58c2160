"""Files that a user wrote, read safely or told in one line."""

from pathlib import Path
from typing import Any

import yaml

from opml.errors import InputError
from opml.files import FilePath

# As safe as SafeLoader, and ten times as fast; each job of the workflow reads the settings anew.
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(path: FilePath) -> Any:
    """Read a YAML file, safely. Raises InputError where it is missing or not YAML."""
    try:
        return yaml.load(Path(path).read_text(encoding="utf-8"), Loader=LOADER)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise InputError(f"{path}: expected YAML ({error})") from None
