"""One schema dialect for three readers: OGC API - Processes 1.0 and OpenAPI 3.0 tools, and JSON Schema 2020-12 validators.

pydantic writes 2020-12. Where OpenAPI 3.0 says the same with another word, the word is chosen that both understand and
that means the same to both; only the names of object keys (`patternProperties`) lose their pattern, which moves into the
description. The server itself validates with the models, not with what is written here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Schema = dict[str, Any]
_ANY_OBJECT_KEYS = {"propertyNames", "patternProperties"}


def to_common_dialect(schema: Schema, definitions: Mapping[str, Schema] | None = None) -> Schema:
    """Rewrite `schema` and all below it; with `definitions`, every `$ref` to them is replaced by what it points at."""
    if "$ref" in schema and definitions is not None:
        target = definitions[str(schema["$ref"]).rsplit("/", 1)[-1]]
        return to_common_dialect({**target, **{key: value for key, value in schema.items() if key != "$ref"}}, definitions)
    rewritten: Schema = {}
    for key, value in schema.items():
        if key in {"$defs", "const", "exclusiveMinimum", "exclusiveMaximum", "prefixItems", "examples", *_ANY_OBJECT_KEYS}:
            continue
        if key in {"properties"}:
            rewritten[key] = {name: to_common_dialect(one, definitions) for name, one in value.items()}
        elif key in {"items", "additionalProperties", "not"} and isinstance(value, dict):
            rewritten[key] = to_common_dialect(value, definitions)
        elif key in {"anyOf", "oneOf", "allOf"}:
            rewritten.update(_alternatives(key, value, definitions))
        else:
            rewritten[key] = value
    rewritten.update(_constant(schema))
    rewritten.update(_open_bounds(schema))
    if "prefixItems" in schema:
        rewritten["items"] = _one_item_schema(schema["prefixItems"], definitions)
    if schema.get("examples"):
        rewritten["example"] = schema["examples"][0]
    if "patternProperties" in schema:
        rewritten.update(_open_object(schema, definitions))
    if rewritten.get("contentMediaType") == "application/octet-stream":
        del rewritten["contentMediaType"]
        rewritten["format"] = "binary"
    return rewritten


def _constant(schema: Schema) -> Schema:
    return {"enum": [schema["const"]]} if "const" in schema else {}


def _alternatives(key: str, value: list[Schema], definitions: Mapping[str, Schema] | None) -> Schema:
    """`X or null` becomes a nullable X: OpenAPI 3.0 has no null type."""
    rest = [to_common_dialect(one, definitions) for one in value if one.get("type") != "null"]
    if len(rest) == len(value):
        return {key: rest}
    if len(rest) == 1 and "$ref" not in rest[0]:
        return {**rest[0], "nullable": True}
    return {"allOf" if len(rest) == 1 else key: rest, "nullable": True}


def _open_bounds(schema: Schema) -> Schema:
    """`x > 0` is `x >= 0 and not x in [0]`: exclusiveMinimum is a number to one dialect and a flag to the other."""
    bounds: Schema = {}
    ends = []
    for strict, plain in (("exclusiveMinimum", "minimum"), ("exclusiveMaximum", "maximum")):
        if strict in schema:
            bounds[plain] = schema[strict]
            ends.append(schema[strict])
    return {**bounds, "not": {"enum": ends}} if ends else {}


def _one_item_schema(items: list[Schema], definitions: Mapping[str, Schema] | None) -> Schema:
    """The schema all items of a fixed-length tuple share; minItems and maxItems keep its length."""
    distinct = [to_common_dialect(item, definitions) for index, item in enumerate(items) if item not in items[:index]]
    return distinct[0] if len(distinct) == 1 else {"anyOf": distinct}


def _open_object(schema: Schema, definitions: Mapping[str, Schema] | None) -> Schema:
    (pattern, values), *others = schema["patternProperties"].items()
    if others:
        raise ValueError(f"an object with several key patterns cannot be written in this dialect: {schema}")
    said = schema.get("description", "")
    return {
        "additionalProperties": to_common_dialect(values, definitions),
        "description": f"{said}{'. ' if said else ''}Keys match {pattern}",
    }
