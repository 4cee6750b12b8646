"""Who asks, and what for: every route works in the workspace of its caller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends
from starlette.requests import Request

from store.scope import Scope
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId

SCOPE_KEY = "access"  # of ASGI's scope


@dataclass(frozen=True, slots=True)
class Access:
    """What the caller may see and do; `key_id` is None where no key is asked for."""

    workspace: WorkspaceId
    scopes: frozenset[Scope]
    key_id: str | None = None


EMBEDDED = Access(DEFAULT_WORKSPACE, frozenset(Scope))
"""Of whoever reaches a server that asks for no keys."""


async def access_of(request: Request) -> Access:
    """The access `api.gate` found; without it nothing is served."""
    access: Access = request.scope[SCOPE_KEY]
    return access


async def workspace_of(request: Request) -> WorkspaceId:
    """The workspace of the request that is being served."""
    return (await access_of(request)).workspace


AccessDep = Annotated[Access, Depends(access_of)]
WorkspaceDep = Annotated[WorkspaceId, Depends(workspace_of)]
