"""A workspace: whose a mesh or job is. Who works in one sees nothing of the others."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime
from typing import NewType

from core.errors import InputError

WorkspaceId = NewType("WorkspaceId", str)
"""A type of its own, so that no other text can take its place among the arguments of the store."""

DEFAULT_WORKSPACE = WorkspaceId("default")
"""There from the start: of everything made before there were workspaces, and of servers that ask for no keys."""

_ID = re.compile(r"[a-z][a-z0-9-]{0,62}")


@dataclass(frozen=True, slots=True)
class Workspace:
    """Its limits are None where the settings of the server hold, 0 where there is none."""

    id: WorkspaceId
    created_at: datetime
    quota_bytes: int | None
    quota_jobs: int | None


def require_workspace_id(text: str) -> WorkspaceId:
    """Raises InputError `workspace.id_invalid`."""
    if not _ID.fullmatch(text):
        raise InputError(
            "workspace.id_invalid",
            f"{text[:80]!r} cannot be the name of a workspace: a small letter, then up to 62 small letters, digits and hyphens",
        )
    return WorkspaceId(text)
