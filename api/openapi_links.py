"""Which operations take the id another one answers with: links of OpenAPI, for generated clients and tests that follow them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

MADE = "201"
MAKERS = {  # operation -> (parameter that takes what it made, where its answer has it)
    "uploadMesh": ("mesh_id", "/id"),
    "makeMeshOfUpload": ("mesh_id", "/id"),
    "createUpload": ("upload_id", "/id"),
    "executeProcess": ("job_id", "/jobID"),
    "createCohort": ("cohort_id", "/id"),
    "createCohortOfArchive": ("cohort_id", "/id"),
    "createCohortOfUpload": ("cohort_id", "/id"),
}


def add_links(document: dict[str, Any]) -> None:
    """To the answers of all makers in a description."""
    takers = dict(_takers(document))
    for _, operation in _operations(document):
        if operation["operationId"] in MAKERS:
            parameter, pointer = MAKERS[operation["operationId"]]
            operation["responses"][MADE]["links"] = {
                name: {"operationId": name, "parameters": {parameter: f"$response.body#{pointer}"}}
                for name, wanted in takers.items()
                if wanted == [parameter]
            }


def _takers(document: dict[str, Any]) -> Iterator[tuple[str, list[str]]]:
    """Every operation, and the parameters in its path."""
    for path, operation in _operations(document):
        yield operation["operationId"], re.findall(r"{(\w+)}", path)


def _operations(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, methods in document["paths"].items():
        for operation in methods.values():
            yield path, operation
