"""The models of the settings as JSON schema, and what a key is in it."""

from functools import cache
from typing import Any

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from opml.base.section import Item, Section
from opml.base.setting_types import TypeSchema

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


@cache
def json_schema(model: type[Section]) -> TypeSchema:
    """Return a model's JSON schema, which is made once and not to be changed."""
    return model.model_json_schema(schema_generator=_Generator)


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
