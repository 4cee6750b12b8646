"""The landing page and the list of conformance classes."""

from __future__ import annotations

from pydantic import Field

from api.schemas.document import Document
from api.schemas.link import Link


class LandingPage(Document):
    """Where everything is."""

    title: str
    description: str
    version: str = Field(description="Version of the server")
    links: tuple[Link, ...]


class Conformance(Document):
    """The conformance classes this server claims."""

    conforms_to: tuple[str, ...] = Field(alias="conformsTo")
