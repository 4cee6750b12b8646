"""Problem details after RFC 9457, with our stable `code` and what a program needs to act on it."""

from __future__ import annotations

from pydantic import Field

from api.schemas.job import ResultReference
from core.errors import Fact
from core.schema.finding import Finding
from core.schema.model import FrozenModel


class Violation(FrozenModel):
    """One thing wrong with a request."""

    pointer: str = Field(description="JSON pointer into the body, or the name of the header, query or path parameter")
    detail: str = Field(description="What is wrong with it, with the numbers that were sent")
    type: str = Field(description="Kind of violation, stable: `extra_forbidden`, `missing`, `greater_than`, ...")


class Problem(FrozenModel):
    """The body of every answer with a status of 400 or more."""

    type: str = Field(description="URI of the kind of problem: OGC's where OGC names it, else `urn:integument:problem:{code}`")
    title: str = Field(description="The kind of problem in words")
    status: int = Field(ge=400, le=599)
    detail: str = Field(description="What happened this time, with numbers and names")
    instance: str = Field(description="Path of the request")
    code: str = Field(description="Stable code, see docs/errors.md", pattern=r"^[a-z0-9_]+(\.[a-z0-9_]+)+$")
    request_id: str = Field(description="Also in the header `X-Request-ID`; quote it when you report the problem")
    retryable: bool = Field(description="True if the same request may succeed later")
    errors: tuple[Violation, ...] = Field((), description="Every violation found in the request")
    facts: dict[str, Fact] = Field({}, description="The numbers and ids of `detail`, for programs")
    findings: tuple[Finding, ...] = Field((), description="Places on the mesh, if geometry is at fault")
    outputs: dict[str, ResultReference] = Field(
        {}, description="What a failed job left, in place of results: name of output -> where to get it"
    )
