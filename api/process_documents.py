"""The catalogue of `core.schema.processes` in OGC's words."""

from __future__ import annotations

from typing import Any

from starlette.requests import Request

from api.dialect import to_common_dialect
from api.links import BASE, EXECUTE_RELATION, JOB_LIST_RELATION, link
from api.schemas.process import InputDescription, OutputDescription, Process, ProcessList, ProcessSummary
from core.errors import StateError
from core.schema.processes import PROCESSES, ProcessDescription

LAYER_OUTPUT = "{layer}"  # stands for the outputs a process names after the layers asked for
TISSUE_OUTPUT = "{tissue}"
SURFACE_OUTPUT = "{surface}"  # and for those named after the surfaces that came
_JSON_MEDIA_TYPES = {"application/json"}


def find_process(process_id: str) -> ProcessDescription:
    """The process of that id, or StateError `process.not_found`."""
    if process_id not in PROCESSES:
        raise StateError("process.not_found", f"There is no process '{process_id[:100]}'; there are {', '.join(PROCESSES)}")
    return PROCESSES[process_id]


def list_processes(request: Request) -> ProcessList:
    """The catalogue document."""
    return ProcessList(
        processes=tuple(summarize_process(request, process) for process in PROCESSES.values()),
        links=(link(request, f"{BASE}/processes", "self", title="Processes"),),
    )


def summarize_process(request: Request, process: ProcessDescription) -> ProcessSummary:
    """One line of the catalogue."""
    path = f"{BASE}/processes/{process.id}"
    return ProcessSummary(
        id=process.id,
        version=process.version,
        title=process.title,
        description=process.description,
        keywords=process.keywords,
        links=(
            link(request, path, "self", title="Description"),
            link(request, f"{path}/execution", EXECUTE_RELATION, title="Execute"),
            link(request, f"{BASE}/jobs", JOB_LIST_RELATION, title="Jobs"),
        ),
    )


def describe_process(request: Request, process: ProcessDescription) -> Process:
    """The full description, with a self-contained schema for every input."""
    summary = summarize_process(request, process)
    return Process(
        **{name: getattr(summary, name) for name in ProcessSummary.model_fields},
        inputs=describe_inputs(process),
        outputs=describe_outputs(process),
    )


def describe_inputs(process: ProcessDescription) -> dict[str, InputDescription]:
    """Every input with its schema; references inside are resolved."""
    schema = process.inputs.model_json_schema(mode="validation")
    definitions: dict[str, dict[str, Any]] = schema.get("$defs", {})
    required = set(schema.get("required", ()))
    described = {}
    for name, one in schema["properties"].items():
        rewritten = to_common_dialect(one, definitions)
        described[name] = InputDescription(
            title=rewritten.get("title", name),
            description=rewritten.get("description", ""),
            json_schema=rewritten,
            min_occurs=int(name in required),
        )
    return described


def describe_outputs(process: ProcessDescription) -> dict[str, OutputDescription]:
    """Every output; layers asked for stand under a placeholder, since their names come with the request."""
    described = {
        name: OutputDescription(title=one.title, description=one.description, json_schema=_file_schema(one.media_type))
        for name, one in process.outputs.items()
    }
    if process.names_layers:
        described[LAYER_OUTPUT] = OutputDescription(
            title="Each layer",
            description="One output per layer of the request, named after it: the layer as delivered, float32",
            json_schema=_file_schema("model/stl"),
        )
    if process.names_tissues:
        described[TISSUE_OUTPUT] = OutputDescription(
            title="Each inner tissue",
            description="One output per tissue of the request, named after it: its surface as delivered, float32",
            json_schema=_file_schema("model/stl"),
        )
    if process.names_surfaces:
        described[SURFACE_OUTPUT] = OutputDescription(
            title="Each surface",
            description="One output per surface of `meshes`, of the package, or of labels, under its name: as delivered, float32",
            json_schema=_file_schema("model/stl"),
        )
    return described


def _file_schema(media_type: str) -> dict[str, Any]:
    """Outputs are files by reference; JSON ones are objects, the rest is bytes."""
    if media_type in _JSON_MEDIA_TYPES:
        return {"type": "object", "contentMediaType": media_type}
    return {"type": "string", "format": "binary", "contentMediaType": media_type}
