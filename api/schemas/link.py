"""Links of OGC API documents."""

from __future__ import annotations

from pydantic import Field

from core.schema.model import FrozenModel


class Link(FrozenModel):
    """A link with its relation."""

    href: str = Field(description="Absolute URL")
    rel: str
    type: str | None = None
    title: str | None = None
