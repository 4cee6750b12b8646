"""Uploaded meshes as documents."""

from __future__ import annotations

from starlette.requests import Request

from api.links import BASE, Query, absolute, link, mesh_path
from api.schemas.link import Link
from api.schemas.mesh import MeshInfo, MeshList
from store.meshes import MeshRecord
from store.page import Page


def describe_mesh(request: Request, record: MeshRecord) -> MeshInfo:
    """What a client may know of a mesh."""
    path = mesh_path(record.id)
    return MeshInfo.model_validate(
        {
            "id": record.id,
            "name": record.name,
            "file_name": record.file_name,
            "unit": record.unit,
            "format": record.format,
            "size_bytes": record.size_bytes,
            "sha256": record.sha256,
            "vertices": record.vertices,
            "faces": record.faces,
            "extents_mm": record.extents_mm,
            "arrays": record.arrays,
            "volume": record.volume,
            "field": record.field,
            "coil": record.coil,
            "findings": record.findings,
            "created": record.created_at,
            "links": (
                link(request, path, "self", title="Mesh"),
                link(request, f"{path}/file", "enclosure", media_type=None, title="File"),
            ),
        }
    )


def list_meshes(request: Request, page: Page[MeshRecord], query: Query) -> MeshList:
    """One page; `query` is repeated in the link to the next page."""
    path = f"{BASE}/meshes"
    links = [link(request, path, "self", title="Meshes")]
    if page.next is not None:
        links.append(Link(href=absolute(request, path, [*query, ("cursor", page.next)]), rel="next", type="application/json"))
    return MeshList(meshes=tuple(describe_mesh(request, record) for record in page.items), next=page.next, links=tuple(links))
