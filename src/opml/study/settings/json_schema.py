"""The models of the settings as JSON schema, and what a key is in it."""

from functools import cache
from typing import Any

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from opml.base.kind_sections import KINDS, OfItsKind
from opml.base.section import Item, Section
from opml.base.setting_types import TypeSchema
from opml.learning.models import learners

_REFERENCE = "#/$defs/"


class _Generator(GenerateJsonSchema):
    """Pydantic's generator, for settings that are laid over others: what they leave out stands there."""

    def dict_schema(self, schema: core_schema.DictSchema) -> TypeSchema:
        """Return the schema of a mapping whose keys are names that a user gives."""
        limits = {"minProperties": schema["min_length"]} if "min_length" in schema else {}
        names, values = (self.generate_inner(schema[part]) for part in ("keys_schema", "values_schema"))
        return {"type": "object", "propertyNames": names, "additionalProperties": values, **limits}

    def model_schema(self, schema: core_schema.ModelSchema) -> TypeSchema:
        """Return the schema of a section; nothing but an item of a list has to be complete."""
        generated = super().model_schema(schema)
        untold = {"title"} if issubclass(schema["cls"], Item) else {"title", "required"}
        return {key: value for key, value in generated.items() if key not in untold}

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> TypeSchema:
        """Return the schema of a setting that may be left out, with its default where that says something."""
        generated = super().default_schema(schema)
        untold = "default" in generated and generated["default"] in (None, "", [], {})
        return {key: value for key, value in generated.items() if not (untold and key == "default")}

    def field_title_should_be_set(self, schema: Any) -> bool:
        """Return False: a field's title would be its key once more."""
        return False


def json_schema(model: type[Section]) -> TypeSchema:
    """Return a model's JSON schema; learners are of the kinds that there are.

    It is made once for these, and not to be changed.
    """
    return _made_once(model, tuple(learners.KINDS.sections()))


@cache
def _made_once(model: type[Section], _: tuple[str, ...]) -> TypeSchema:
    schema = _generated(model)
    schema.setdefault("$defs", {})[learners.KINDS.name] = _of_any_kind(learners.KINDS)
    return schema


def dereferenced(schema: TypeSchema, node: TypeSchema, value: Any = None) -> TypeSchema:
    """Return what a node of a schema stands for: what it refers to, and of several kinds that of a value."""
    references = [choice["$ref"] for choice in (node, *node.get("anyOf", [])) if "$ref" in choice]
    if references:
        return dereferenced(schema, schema["$defs"][references[0].removeprefix(_REFERENCE)], value)
    kind = value.get("kind") if isinstance(value, dict) else None
    for choice in node.get("allOf", []):
        if choice["if"]["properties"]["kind"]["const"] == kind:
            return choice["then"]
    return node


def child(node: TypeSchema, key: str | int) -> TypeSchema | None:
    """Return the node of a key or an index below a resolved node, None where there is none."""
    if isinstance(key, str):
        below: TypeSchema | None = node.get("properties", {}).get(key)
        others = node.get("additionalProperties")
        return below if below is not None else others if isinstance(others, dict) else None
    items = node.get("prefixItems", [])
    return items[key] if key < len(items) else node.get("items")


def choices(node: TypeSchema) -> list[Any]:
    """Return the values that a node takes; none where it takes others."""
    return node.get("enum") or [node[key] for key in ("const",) if key in node]


def _generated(model: type[Section]) -> TypeSchema:
    return _with_references(model.model_json_schema(schema_generator=_Generator))


def _of_any_kind(kinds: OfItsKind) -> TypeSchema:
    models = {kind: _generated(section) for kind, section in kinds.sections().items()}
    return {
        "type": "object",
        "properties": {"kind": {"enum": list(models)}},
        "allOf": [
            {
                "if": {"properties": {"kind": {"const": kind}}, "required": ["kind"]},
                "then": {key: value for key, value in model.items() if key != "description"},
            }
            for kind, model in models.items()
        ],
    }


def _with_references(node: Any) -> Any:
    """Return a schema in which settings of any kind refer to their definition, which may hold itself."""
    if isinstance(node, list):
        return [_with_references(item) for item in node]
    if not isinstance(node, dict):
        return node
    named = {"$ref": f"{_REFERENCE}{node[KINDS]}"} if KINDS in node else {}
    return {key: _with_references(value) for key, value in node.items() if key != KINDS} | named
