"""Callbacks of a job: what was to be told, and whether it was heard."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import Field

from api.schemas.document import Document


class CallbackInfo(Document):
    """One message to the subscriber."""

    id: str = Field(description="Also the header `webhook-id` of every attempt")
    event: Literal["inProgress", "success", "failed"]
    uri: str
    state: Literal["pending", "delivered", "dead"] = Field(description="`dead`: given up, after ten attempts or an answer of 410")
    attempts: int = Field(ge=0, description="Attempts begun")
    created: datetime
    due: datetime | None = Field(None, description="When it is sent next; only while pending")
    ended: datetime | None = None
    last_status: int | None = Field(None, alias="lastStatus", description="HTTP status of the last answer")
    last_error: str | None = Field(None, alias="lastError", description="What went wrong the last time")


class CallbackList(Document):
    """All callbacks of a job, in the order they came about."""

    callbacks: tuple[CallbackInfo, ...]
