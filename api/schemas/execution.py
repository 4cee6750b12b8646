"""The body that executes a process (OGC execute.yaml)."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from api.schemas.document import Document


class OutputRequest(Document):
    """How one output is wanted. Outputs are files: they are always given by reference."""

    transmission_mode: Literal["reference"] = Field("reference", alias="transmissionMode")


class ExecuteRequest(Document):
    """A request to run a process. Inputs have the schemas of the process description."""

    inputs: dict[str, Any] = Field({}, description="See GET /v1/processes/{id}")
    outputs: dict[str, OutputRequest] | None = Field(
        None, description="Names that must be among the process' outputs; all are made"
    )
    response: Literal["document"] = Field("document", description="Results come as a document of references")
