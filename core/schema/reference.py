"""Input references: an uploaded mesh, an output of an earlier job, or the package of one."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from core.schema.model import FrozenModel

CANONICAL_MEDIA_TYPE = "application/x-integument-mesh"  # the internal form of an upload (core.io.canonical)
VOLUME_MEDIA_TYPE = "application/x-integument-volume"  # the internal form of an uploaded label volume (core.io.canonical_volume)
FIELD_MEDIA_TYPE = "application/x-integument-field"  # the internal form of an uploaded field (core.io.canonical_field)
COIL_MEDIA_TYPE = "application/x-integument-coil"  # the internal form of an uploaded coil (core.io.canonical_coil)
MESH_MEDIA_TYPES = (CANONICAL_MEDIA_TYPE, "model/stl")
PACKAGE_MEDIA_TYPES = ("application/zip",)
MESH_HREF = r"/v1/meshes/[0-9a-f-]{36}"
RESULT_HREF = r"/v1/jobs/[0-9a-f-]{36}/results/[A-Za-z0-9_.-]{1,64}"


class MeshReference(FrozenModel):
    """A link to a mesh this server holds. Absolute URLs of this server are accepted: only the path counts."""

    href: str = Field(
        description="`/v1/meshes/{id}` or `/v1/jobs/{id}/results/{output}`",
        max_length=500,
        pattern=rf"^(https?://[^/]+)?({MESH_HREF}|{RESULT_HREF})$",
    )
    type: str | None = Field(None, description="Ignored; OGC clients may send a media type", max_length=200)
    rel: str | None = Field(None, description="Ignored", max_length=200)
    title: str | None = Field(None, description="Ignored", max_length=200)
    hreflang: str | None = Field(None, description="Ignored", max_length=50)


class PackageReference(MeshReference):
    """A link to the package of an earlier job: all its surfaces with their names, depths and conductivities."""

    href: str = Field(
        description="`/v1/jobs/{id}/results/package` of a job that made one",
        max_length=500,
        pattern=rf"^(https?://[^/]+)?{RESULT_HREF}$",
    )


def _upload_href(formats: str, media_type: str) -> Any:
    """The link of an upload that is no surface; `contentMediaType` tells forms which uploads to offer."""
    return Field(
        description=f"`/v1/meshes/{{id}}` of an upload whose format is {formats}",
        max_length=500,
        pattern=rf"^(https?://[^/]+)?{MESH_HREF}$",
        json_schema_extra={"contentMediaType": media_type},
    )


class VolumeReference(MeshReference):
    """A link to a label volume this server holds."""

    href: str = _upload_href("nifti or mgh", VOLUME_MEDIA_TYPE)


class FieldReference(MeshReference):
    """A link to a field this server holds."""

    href: str = _upload_href("msh or table", FIELD_MEDIA_TYPE)


class CoilReference(MeshReference):
    """A link to a coil this server holds."""

    href: str = _upload_href("ccd or tcd", COIL_MEDIA_TYPE)
