"""An API key as everybody but its owner sees it."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime

from store.scope import Scope
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class ApiKey:
    """`replaced_by` is the id of the key that was made when this one was rotated."""

    id: str
    workspace: WorkspaceId
    name: str
    scopes: frozenset[Scope]
    created_at: datetime
    expires_at: datetime | None
    last_used_at: datetime | None
    revoked_at: datetime | None
    replaced_by: str | None

    def state_at(self, now: datetime) -> str:
        """`live`, `expired` or `revoked`."""
        if self.revoked_at is not None:
            return "revoked"
        return "expired" if self.expires_at is not None and self.expires_at <= now else "live"


@dataclass(frozen=True, slots=True)
class IssuedKey:
    """A key at the only moment its text is known."""

    key: ApiKey
    text: str = field(repr=False)
