"""Reader of YAML files: safe, strict about keys, with errors in one line."""

import json
import re
from typing import Any

import yaml

from opml.base.errors import InputError
from opml.base.files import FilePath, read_text

_INTEGER = re.compile(r"[-+]?(?:0|[1-9][0-9_]*)$")
_FLOAT = re.compile(
    r"[-+]?(?:[0-9][0-9_]*\.[0-9_]*|\.[0-9][0-9_]*)(?:[eE][-+]?[0-9]+)?$|[-+]?\.(?:inf|Inf|INF)$|\.(?:nan|NaN|NAN)$"
)
"""Pattern of a number: not 010, which YAML 1.1 takes for 8, nor 2:10, which it takes for 130."""


# As safe as SafeLoader, and ten times as fast; each job of the workflow reads the settings.
class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """A safe loader that refuses a key given twice; YAML's own would keep the last one without a word."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Return the mapping. Raises ConstructorError with both lines where a key is given twice."""
        lines: dict[str, int] = {}
        for key, _ in node.value:
            line = key.start_mark.line + 1
            if isinstance(key, yaml.ScalarNode) and key.value in lines:
                first = lines[key.value]
                raise yaml.constructor.ConstructorError(
                    None, None, f"key {key.value} given twice, in lines {first} and {line}", None
                )
            if isinstance(key, yaml.ScalarNode):
                lines[key.value] = line
        return super().construct_mapping(node, deep)


# Texts are numbers of the loader that are written in tens, with all their digits.
_TAGS = {"tag:yaml.org,2002:int": _INTEGER, "tag:yaml.org,2002:float": _FLOAT}
_Loader.yaml_implicit_resolvers = {
    first: [(tag, _TAGS.get(tag, pattern)) for tag, pattern in resolvers]
    for first, resolvers in _Loader.yaml_implicit_resolvers.items()
}


def read_yaml(path: FilePath) -> Any:
    """Read a YAML file, safely. Raises InputError where it is missing, not YAML or has a key twice."""
    text = read_text(path, "YAML in UTF-8")
    try:
        values = yaml.load(text, Loader=_Loader)
        json.dumps(values, skipkeys=True, default=str)  # raises where an alias stands for what it is in
        return values
    except (ValueError, yaml.YAMLError) as error:
        for number, line in enumerate(text.splitlines(), start=1):
            if line.lstrip(" ").startswith("\t"):
                message = f"{path}: expected YAML (a tab begins line {number}, where spaces should)"
                raise InputError(message) from None
        raise InputError(f"{path}: expected YAML ({error})") from None
