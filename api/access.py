"""Who asks, and what for: every route works in the workspace of its caller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends
from starlette.requests import Request

from store.workspace import DEFAULT_WORKSPACE, WorkspaceId


@dataclass(frozen=True, slots=True)
class Access:
    """What the caller may see."""

    workspace: WorkspaceId


EMBEDDED = Access(DEFAULT_WORKSPACE)
"""Of whoever reaches the loopback port of a server that asks for no keys."""


def access_of(_request: Request) -> Access:
    """The access of the request that is being served."""
    return EMBEDDED


def workspace_of(request: Request) -> WorkspaceId:
    """The workspace of the request that is being served."""
    return access_of(request).workspace


WorkspaceDep = Annotated[WorkspaceId, Depends(workspace_of)]
