"""Uploaded meshes."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import anyio
from fastapi import APIRouter, Query, Request, Response
from sqlalchemy.orm import Session
from starlette.concurrency import run_in_threadpool

from api.access import WorkspaceDep
from api.downloads import Download, send_download
from api.idempotency import REPLAYED, Once, fingerprint_of
from api.intake import name_of, parse, require_mesh, require_unit
from api.links import BASE, mesh_path
from api.mesh_documents import describe_mesh, list_meshes
from api.mesh_export import WRITTEN_AS, StoredMesh, export_mesh
from api.paging import add_next_link
from api.parameters import Cursor, IdempotencyKey, MeshId, MostFaces, PageLimit, TextFilter
from api.request_folder import request_folder
from api.responses import files, problems
from api.schemas.mesh import MeshInfo, MeshList
from api.scratch import FolderDep
from api.services import Services, ServicesDep
from api.stored_download import stored_download
from api.upload_form import ReceivedFile, receive_file
from store.idempotency import Reply
from store.meshes import CANONICAL_MEDIA_TYPE, MeshRecord
from store.workspace import WorkspaceId

router = APIRouter(prefix="/meshes", tags=["Meshes"])

FileFormat = Literal["original", "stl", "stl-ascii", "mat", "ply", "obj", "glb", "vtu"]
FILE_MEDIA_TYPES = ("application/octet-stream", *sorted({media_type for media_type, _extension in WRITTEN_AS.values()}))
_UPLOAD_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {
                        "file": {
                            "type": "string",
                            "format": "binary",
                            "description": "STL, MAT, PLY, OBJ; labels (.nii, .mgz); a field (.msh, .csv); a coil (.ccd, .tcd)",
                        },
                        "unit": {
                            "type": "string",
                            "enum": ["m", "cm", "mm", "in"],
                            "default": "mm",
                            "description": "Unit of the coordinates in the file",
                        },
                        "name": {"type": "string", "description": "Name of the mesh; the file's name without one"},
                    },
                }
            }
        },
    }
}


@router.post(
    "",
    operation_id="uploadMesh",
    status_code=201,
    response_model_exclude_none=True,
    responses=problems(409, 413, 415, 422, 503, 507),
    openapi_extra=_UPLOAD_BODY,
)
async def upload_mesh(
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    idempotency_key: IdempotencyKey = None,
) -> MeshInfo:
    """Send a mesh, a label volume, a field or a coil. The answer says what was found in it, or what is wrong with it."""
    await run_in_threadpool(services.quotas.check_room_for_bytes, workspace, 0)  # before gigabytes come for nothing
    with request_folder(services.incoming_dir) as folder:
        received = await receive_file(request, folder / "upload", services.settings.upload_limit_bytes)
        record, replayed = await anyio.to_thread.run_sync(
            _take_in, services, workspace, received, folder, idempotency_key, limiter=services.intake_slots
        )
    response.headers["Location"] = mesh_path(record.id)
    if replayed:
        response.headers[REPLAYED] = "true"
    return describe_mesh(request, record)


def _take_in(
    services: Services, workspace: WorkspaceId, received: ReceivedFile, folder: Path, key: str | None
) -> tuple[MeshRecord, bool]:
    """The mesh, and whether an earlier request with this key made it."""
    unit = require_unit(received)
    told = {"file": received.sha256, "file_name": received.file_name, "unit": unit, "name": name_of(received)}
    once = Once(services, workspace, key, fingerprint_of("POST", f"{BASE}/meshes", told))

    def take_in() -> MeshRecord:
        upload = parse(services, received, unit, folder)

        def remember(record: MeshRecord, session: Session) -> None:
            once.keep(Reply(201, {"Location": mesh_path(record.id)}, {"mesh": record.id}), session)

        return services.meshes.create(workspace, upload, also=remember)

    return once.answer(take_in, lambda kept: services.meshes.get(workspace, str(kept["mesh"])))


@router.get("", operation_id="listMeshes", response_model_exclude_none=True, responses=problems(422))
def get_meshes(
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    q: TextFilter = "",
    limit: PageLimit = 50,
    cursor: Cursor = None,
) -> MeshList:
    """The meshes of the workspace, newest first."""
    page = services.meshes.list(workspace, text=q, limit=limit, cursor=cursor)
    meshes = list_meshes(request, page, [("q", q)] * bool(q) + [("limit", str(limit))])
    add_next_link(response, meshes.links)
    return meshes


@router.get("/{mesh_id}", operation_id="getMesh", response_model_exclude_none=True, responses=problems(404))
def get_mesh(mesh_id: MeshId, request: Request, services: ServicesDep, workspace: WorkspaceDep) -> MeshInfo:
    """What is known of one mesh."""
    return describe_mesh(request, services.meshes.get(workspace, mesh_id))


@router.delete("/{mesh_id}", operation_id="deleteMesh", status_code=204, responses=problems(404))
def delete_mesh(mesh_id: MeshId, services: ServicesDep, workspace: WorkspaceDep) -> None:
    """Forget a mesh. Jobs that were accepted with it keep its bytes and go on."""
    services.meshes.delete(workspace, mesh_id)


@router.head("/{mesh_id}/file", include_in_schema=False)
@router.get(
    "/{mesh_id}/file",
    operation_id="getMeshFile",
    response_class=Response,
    responses=files("The file", *FILE_MEDIA_TYPES) | problems(422, 413),
)
async def get_mesh_file(
    mesh_id: MeshId,
    request: Request,
    services: ServicesDep,
    workspace: WorkspaceDep,
    folder: FolderDep,
    file_format: Annotated[
        FileFormat, Query(alias="format", description="`original`: the bytes as sent; all others in mm, as jobs read the mesh")
    ] = "original",
    most_faces: MostFaces = None,
) -> Response:
    """The mesh as a file."""
    record = await run_in_threadpool(services.meshes.get, workspace, mesh_id)
    if file_format == "original":
        return send_download(request, await run_in_threadpool(_original, services, record))
    require_mesh(record)
    stored = StoredMesh(record.canonical_sha256, CANONICAL_MEDIA_TYPE, record.file_name, record.name)
    export = partial(export_mesh, services, stored, file_format, most_faces, folder)
    download = await anyio.to_thread.run_sync(export, limiter=services.intake_slots)
    return send_download(request, download)


def _original(services: Services, record: MeshRecord) -> Download:
    return stored_download(
        services.blobs,
        record.sha256,
        record.size_bytes,
        file_name=record.file_name,
        media_type="application/octet-stream",
    )
