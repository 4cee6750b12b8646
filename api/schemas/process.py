"""Processes as OGC describes them (processSummary, process, inputDescription, outputDescription)."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from api.schemas.document import Document
from api.schemas.link import Link

JobControlOption = Literal["async-execute", "dismiss"]
TransmissionMode = Literal["reference"]


class ProcessSummary(Document):
    """One line of the catalogue."""

    id: str
    version: str
    title: str
    description: str
    keywords: tuple[str, ...]
    job_control_options: tuple[JobControlOption, ...] = Field(("async-execute", "dismiss"), alias="jobControlOptions")
    output_transmission: tuple[TransmissionMode, ...] = Field(("reference",), alias="outputTransmission")
    links: tuple[Link, ...]


class InputDescription(Document):
    """One input. `schema` is readable as JSON Schema 2020-12 and as OpenAPI 3.0 schema object."""

    title: str
    description: str
    json_schema: dict[str, Any] = Field(alias="schema")
    min_occurs: int = Field(alias="minOccurs", description="0: may be left out, then the default of the schema holds")
    max_occurs: int = Field(1, alias="maxOccurs")


class OutputDescription(Document):
    """One output."""

    title: str
    description: str
    json_schema: dict[str, Any] = Field(alias="schema")


class Process(ProcessSummary):
    """All a client needs to execute a process."""

    inputs: dict[str, InputDescription]
    outputs: dict[str, OutputDescription]


class ProcessList(Document):
    """The catalogue."""

    processes: tuple[ProcessSummary, ...]
    links: tuple[Link, ...]
