"""JSON Schema as Markdown tables: what a key takes, within which limits, and what it is when left out."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

Schema = Mapping[str, Any]
Link = Callable[[str], str]
"""Name of a definition -> Markdown that leads to its table."""

LIMITS = {
    "exclusiveMinimum": "> {}",
    "minimum": "≥ {}",
    "exclusiveMaximum": "< {}",
    "maximum": "≤ {}",
    "minLength": "at least {} characters",
    "maxLength": "at most {} characters",
    "minItems": "at least {}",
    "maxItems": "at most {}",
    "minProperties": "at least {}",
    "maxProperties": "at most {}",
}
FILLERS = {"Ignored", "Ignored; OGC clients may send a media type"}  # keys that a link may carry and nobody reads


def property_table(schema: Schema, link: Link, definitions: Mapping[str, Schema] = MappingProxyType({})) -> str:
    """One row per property, what must be given first. Empty if the schema has none.

    definitions: those the properties refer to; their words stand in for missing ones, what they have by default is left out."""
    required = set(schema.get("required", ()))
    properties = sorted(schema.get("properties", {}).items(), key=lambda pair: pair[0] not in required)
    rows = [
        f"| `{name}` | {_cell(type_of(value, link))} | {_default(name, value, required, definitions)} "
        f"| {_meaning(value, definitions)} |"
        for name, value in properties
        if value.get("description") not in FILLERS
    ]
    return "\n".join(["| key | takes | default | meaning |", "|---|---|---|---|", *rows]) + "\n" if rows else ""


def type_of(schema: Schema, link: Link) -> str:
    """In words: `number > 0`, `list of Layer, at most 16`."""
    if "$ref" in schema:
        return link(schema["$ref"].rpartition("/")[2])
    for key in ("anyOf", "oneOf", "allOf"):
        if key in schema:
            return " or ".join(type_of(option, link) for option in schema[key])
    if "const" in schema:
        return _code(schema["const"])
    if "enum" in schema:
        return " or ".join(_code(value) for value in schema["enum"])
    words = _noun(schema, link)
    if "pattern" in schema and schema.get("type") == "string":
        words += f" like `{schema['pattern']}`"
    limits = ", ".join(_limits(schema))
    return f"{words}{', ' if limits and schema.get('type') != 'number' else ' '}{limits}".strip()


def named_in(schema: Schema, definitions: Mapping[str, Schema]) -> list[str]:
    """Definitions that `schema` leads to, each once, in the order a reader meets them."""
    found: list[str] = []
    waiting = [schema]
    while waiting:
        for name in _references(waiting.pop(0)):
            if name not in found:
                found.append(name)
                waiting.append(definitions[name])
    return found


def _references(schema: object) -> Iterator[str]:
    if isinstance(schema, Mapping):
        if isinstance(schema.get("$ref"), str):
            yield str(schema["$ref"]).rpartition("/")[2]
        for value in schema.values():
            yield from _references(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from _references(value)


def _noun(schema: Schema, link: Link) -> str:
    kind = schema.get("type", "anything")
    if kind == "array":
        if "prefixItems" in schema:
            return f"[{', '.join(type_of(item, link) for item in schema['prefixItems'])}]"
        return f"list of {type_of(schema['items'], link)}" if "items" in schema else "list"
    if kind == "object":
        values = schema.get("additionalProperties") or next(iter(schema.get("patternProperties", {}).values()), None)
        return f"object of name: {type_of(values, link)}" if isinstance(values, Mapping) and values else "object"
    if kind == "null":
        return "`null`"
    suffix = {"date-time": " (date and time)", "uuid": " (UUID)", "binary": " (bytes)"}.get(schema.get("format", ""), "")
    return f"{kind}{suffix}{' or `null`' if schema.get('nullable') else ''}"


def _limits(schema: Schema) -> Iterator[str]:
    if schema.get("type") == "array" and "prefixItems" in schema:
        return
    for key, words in LIMITS.items():
        value = schema.get(key)
        if isinstance(value, bool):  # OpenAPI 3.0: `exclusiveMinimum: true` beside `minimum`
            continue
        if value is not None:
            strict = key in ("minimum", "maximum") and schema.get("exclusive" + key.capitalize()) is True
            yield (
                words.replace("≥", ">" if strict else "≥")
                .replace("≤", "<" if strict else "≤")
                .format(f"{value:,}".removesuffix(".0"))
            )


def _default(name: str, schema: Schema, required: set[str], definitions: Mapping[str, Schema]) -> str:
    if name in required:
        return "**required**"
    if "default" not in schema:
        return ""
    return _code(_told(schema["default"], _referred(schema, definitions)))


def _told(default: Any, definition: Schema) -> Any:
    """What of a default does not follow from the defaults of its parts."""
    if isinstance(default, list):
        return [_told(item, definition) for item in default]
    if isinstance(default, dict):
        own = {name: part.get("default", part) for name, part in definition.get("properties", {}).items()}
        return {key: value for key, value in default.items() if key not in own or own[key] != value}
    return default


def _referred(schema: Schema, definitions: Mapping[str, Schema]) -> Schema:
    """The definition a property, or what is listed in it, is made of; empty if there is none, or more than one."""
    names = list(_references(schema))
    return definitions.get(names[0], {}) if len(names) == 1 else {}


def _meaning(schema: Schema, definitions: Mapping[str, Schema]) -> str:
    return _cell(schema.get("description") or _referred(schema, definitions).get("description", ""))


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _code(value: object) -> str:
    return f"`{_cell(json.dumps(value, ensure_ascii=False))}`"
