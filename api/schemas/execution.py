"""The body that executes a process (OGC execute.yaml)."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from api.schemas.document import Document
from api.schemas.job_words import Labels, Name


class OutputRequest(Document):
    """How one output is wanted. Outputs are files: they are always given by reference."""

    transmission_mode: Literal["reference"] = Field("reference", alias="transmissionMode")


class SubscriberRequest(Document):
    """Whom to tell (OGC subscriber.yaml): each URI gets a signed POST with the job's statusInfo, see docs/api.md."""

    success_uri: str = Field(alias="successUri", description="Told when the job is successful; https")
    in_progress_uri: str | None = Field(None, alias="inProgressUri", description="Told when an attempt starts")
    failed_uri: str | None = Field(None, alias="failedUri", description="Told when the job has failed or was dismissed")


class ExecuteRequest(Document):
    """A request to run a process. Inputs have the schemas of the process description."""

    inputs: dict[str, Any] = Field({}, description="See GET /v1/processes/{id}")
    outputs: dict[str, OutputRequest] | None = Field(
        None, description="Names that must be among the process' outputs; all are made"
    )
    subscriber: SubscriberRequest | None = Field(None, description="Callbacks; only where the server has a secret to sign them")
    name: Name | None = Field(None, description="What people call the job, up to 200 characters")
    labels: Labels = Field((), description="To find it by, `pilot` or `site=Boston`: up to 20, each up to 64 characters")
    response: Literal["document"] = Field("document", description="Results come as a document of references")

    def identity(self) -> dict[str, Any]:
        """What makes two requests the same. Without name and labels it says what servers without these words said."""
        told = self.model_dump(mode="json")
        return {key: value for key, value in told.items() if value or key not in ("name", "labels")}
