"""An upload in pieces."""

from __future__ import annotations

from datetime import datetime

from pydantic import Field

from api.schemas.document import Document
from api.schemas.link import Link


class UploadInfo(Document):
    """How far an upload is."""

    id: str
    file_name: str
    length: int = Field(description="Bytes announced")
    received: int = Field(description="Bytes that are safely here")
    mesh: str | None = Field(None, description="Id of the mesh that was made of it")
    created: datetime
    expires: datetime = Field(description="It is forgotten then, unless it goes on before")
    links: tuple[Link, ...]


class MeshFromUpload(Document):
    """How to read a finished upload; what is left out is as `Upload-Metadata` said."""

    unit: str | None = Field(None, description="m, cm, mm or in")
    name: str | None = Field(None, max_length=2000)
