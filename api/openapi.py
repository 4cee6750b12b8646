"""The OpenAPI description: what FastAPI knows of the routes, in the words of OpenAPI 3.0 (conformance class oas30)."""

from __future__ import annotations

import json
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from api.callback_description import describe_callbacks
from api.dialect import to_common_dialect
from api.needed_scope import needed_scope
from api.openapi_links import add_links
from api.problems import MEDIA_TYPE
from api.responses import problems
from api.schemas.job_report import JobReport
from core.schema.processes import PROCESSES

OPENAPI_VERSION = "3.0.3"
TAGS = [
    {"name": "Capabilities", "description": "Landing page and conformance"},
    {"name": "Meshes", "description": "Uploads"},
    {"name": "Processes", "description": "What can be done, and doing it"},
    {"name": "Jobs", "description": "Status, events, dismissal"},
    {"name": "Results", "description": "Outputs and reports"},
    {"name": "Health", "description": "For supervisors and dashboards"},
]
_REF = "#/components/schemas/{model}"
SECURITY = "apiKey"
SECURITY_SCHEME = {
    "type": "http",
    "scheme": "bearer",
    "bearerFormat": "itg_<id>_<secret>_<checksum>",
    "description": "An API key, made by `integument admin keys create`. Never in a URL.",
}
EXECUTE = "executeProcess"
GATE_STATUSES = (401, 403, 429)
_FRAMEWORK_SCHEMAS = ("HTTPValidationError", "ValidationError")


def openapi_bytes(app: FastAPI) -> bytes:
    """The description as served and committed."""
    return (json.dumps(app.openapi(), indent=2, ensure_ascii=False) + "\n").encode()


def install_openapi(app: FastAPI) -> None:
    """Let `app` describe itself our way; built when first asked for."""

    def describe() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = build_openapi(app)
        return app.openapi_schema

    app.openapi = describe  # type: ignore[method-assign]


def build_openapi(app: FastAPI) -> dict[str, Any]:
    """The whole document."""
    document = get_openapi(title=app.title, version=app.version, description=app.description, routes=app.routes, tags=TAGS)
    document["openapi"] = OPENAPI_VERSION
    document["info"]["license"] = {"name": "AGPL-3.0-or-later", "url": "https://www.gnu.org/licenses/agpl-3.0.html"}
    schemas: dict[str, Any] = document["components"]["schemas"]
    _add_inputs(schemas)
    for name in _FRAMEWORK_SCHEMAS:
        schemas.pop(name, None)
    document["components"]["schemas"] = {name: to_common_dialect(schema) for name, schema in sorted(schemas.items())}
    document["components"]["securitySchemes"] = {SECURITY: SECURITY_SCHEME}
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            _add_security(method, path, operation)
            _rewrite(operation)
            if operation["operationId"] == EXECUTE:
                operation["callbacks"] = describe_callbacks()
    add_links(document)
    return document


def _add_inputs(schemas: dict[str, Any]) -> None:
    """Describe the inputs of each process where the body of an execution has only an object, and the report."""
    models: list[type[BaseModel]] = [*(process.inputs for process in PROCESSES.values()), JobReport]
    _, told = models_json_schema([(model, "validation") for model in models], ref_template=_REF)
    schemas.update({name: schema for name, schema in told["$defs"].items() if name not in schemas})
    inputs = schemas["ExecuteRequest"]["properties"]["inputs"]
    schemas["ExecuteRequest"]["properties"]["inputs"] = {
        "anyOf": [{"$ref": _REF.format(model=process.inputs.__name__)} for process in PROCESSES.values()],
        "description": inputs["description"],
    }


def _add_security(method: str, path: str, operation: dict[str, Any]) -> None:
    """What `api.gate` asks for and refuses with, in front of every route."""
    need = needed_scope(method, path)
    if need is None:
        operation["security"] = []
        return
    operation["security"] = [{SECURITY: []}, {}]  # the second: a server without keys asks for none
    operation["description"] = f"{operation.get('description', '')}\n\nScope of the API key: `{need}`.".strip()
    problem = {"application/json": {"schema": {"$ref": _REF.format(model="Problem")}}}
    declared = problems(*GATE_STATUSES)
    refusals = {str(status): {"description": declared[status]["description"], "content": problem} for status in GATE_STATUSES}
    operation["responses"] = dict(sorted({**refusals, **operation["responses"]}.items()))


def _rewrite(operation: dict[str, Any]) -> None:
    for parameter in operation.get("parameters", ()):
        parameter["schema"] = to_common_dialect(parameter["schema"])
    if _FRAMEWORK_SCHEMAS[0] in json.dumps(operation["responses"].get("422", {})):
        del operation["responses"]["422"]  # the framework's guess: what a route refuses is declared at the route
    contents = [operation.get("requestBody", {}).get("content", {})]
    for status, response in operation["responses"].items():
        content = response.get("content", {})
        if int(status) >= 400:  # the framework gives problems the media type of the route's answers
            (media,) = content.values()
            response["content"] = content = {MEDIA_TYPE: media}
        contents.append(content)
    for content in contents:
        for media in content.values():
            media.pop("itemSchema", None)  # a word of OpenAPI 3.2
            if "schema" in media:
                media["schema"] = to_common_dialect(media["schema"])
