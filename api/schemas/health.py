"""Health of the process and of what it needs."""

from __future__ import annotations

from typing import Literal

from api.schemas.document import Document


class Health(Document):
    """The process answers."""

    status: Literal["ok"] = "ok"


class Readiness(Document):
    """Everything a request needs is there."""

    status: Literal["ready"] = "ready"
    checks: dict[str, Literal["ok"]]
