"""What a job was asked for."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from api.schemas.document import Document


class JobInputs(Document):
    """Fit to be sent to the same process again."""

    process_id: str = Field(alias="processID")
    inputs: dict[str, Any] = Field(description="As sent, defaults filled in, links as paths of this server")
