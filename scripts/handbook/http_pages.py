"""The HTTP reference: one page per group of requests and one of all schemas, from openapi/openapi.json."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from scripts.handbook.schema_tables import property_table, type_of

METHODS = ("get", "head", "post", "put", "patch", "delete", "options")
SCHEMAS = "schemas"
WORDS = {"Successful Response": "As asked for"}  # the framework's, where the route says nothing of its own


def http_pages(openapi: Path) -> dict[str, str]:
    """File name -> Markdown; `schemas.md` and one page per tag."""
    document = json.loads(openapi.read_text(encoding="utf-8"))
    groups: dict[str, list[str]] = {}
    for path, operations in document["paths"].items():
        for method in METHODS:
            if method in operations:
                operation = operations[method]
                groups.setdefault(operation["tags"][0], []).append(_operation(method, path, operation))
    told = {tag["name"]: tag.get("description", "") for tag in document.get("tags", ())}
    pages = {f"{tag.lower()}.md": f"# HTTP: {tag}\n\n{told.get(tag, '')}\n\n" + "\n".join(texts) for tag, texts in groups.items()}
    return {**pages, f"{SCHEMAS}.md": _schemas(document["components"]["schemas"])}


def _operation(method: str, path: str, operation: Mapping[str, Any]) -> str:
    parts = [f"## `{method.upper()} {path}`\n", f"{operation.get('description', '')}\n"]
    parameters = operation.get("parameters", ())
    if parameters:
        parts.append("| parameter | in | takes | meaning |\n|---|---|---|---|")
        parts += [
            f"| `{one['name']}`{' (required)' if one.get('required') else ''} | {one['in']} "
            f"| {_cell(type_of(one.get('schema', {}), _link))} | {_cell(one.get('description', ''))} |"
            for one in parameters
        ]
        parts.append("")
    for media_type, content in operation.get("requestBody", {}).get("content", {}).items():
        schema = content.get("schema", {})
        table = property_table(schema, _link)
        parts.append(f"**Body** `{media_type}`{':' if table else f': {type_of(schema, _link)}'}\n\n{table}")
    parts.append("| status | what | body |\n|---|---|---|")
    parts += [
        f"| {status} | {_cell(WORDS.get(answer['description'], answer['description']))} | {_bodies(answer)} |"
        for status, answer in operation["responses"].items()
    ]
    return "\n".join(parts) + "\n"


def _bodies(answer: Mapping[str, Any]) -> str:
    return _cell(", ".join(_body(media_type, content) for media_type, content in answer.get("content", {}).items()))


def _body(media_type: str, content: Mapping[str, Any]) -> str:
    schema = content.get("schema", {})
    return f"`{media_type}`: {type_of(schema, _link)}" if "$ref" in schema else f"`{media_type}`"


def _schemas(schemas: Mapping[str, Mapping[str, Any]]) -> str:
    return "# HTTP: Schemas\n\nEvery document of the API, by name.\n\n" + "\n".join(_schema_parts(schemas))


def _schema_parts(schemas: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    for name, schema in sorted(schemas.items()):
        table = property_table(schema, _link) or f"{type_of(schema, _link)}\n"
        yield f"(schema-{name.lower()})=\n## {name}\n\n{schema.get('description', '')}\n\n{table}"


def _link(name: str) -> str:
    return f"[{name}](#schema-{name.lower()})"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("\\\\|", "\\|")
