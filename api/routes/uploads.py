"""Resumable uploads: tus 1.0.0 with creation, expiration, termination and checksum; then one request more makes a mesh, or
(`api.routes.cohorts`) a cohort."""

from __future__ import annotations

import shutil
from functools import partial
from typing import Annotated, Any

import anyio
from fastapi import APIRouter, Body, Request, Response

from api.access import WorkspaceDep
from api.intake import parse, require_unit
from api.links import link, mesh_path, upload_path
from api.locked_upload import locked_upload
from api.mesh_documents import describe_mesh
from api.parameters import UploadId
from api.partial_file import partial_file
from api.receiving import Receiving
from api.request_body import RequestBody
from api.responses import problems
from api.schemas.mesh import MeshInfo
from api.schemas.upload import MeshFromUpload, UploadInfo
from api.services import Services, ServicesDep
from api.tus import (
    ALGORITHMS,
    EXTENSIONS,
    HEADERS,
    PATCH_MEDIA_TYPE,
    VERSION,
    ChecksumDep,
    Versioned,
    expires,
    metadata_of,
    number_of,
)
from api.upload_form import plain_name
from core.errors import InputError, LimitError
from store.meshes import MeshRecord
from store.uploads import Upload
from store.workspace import WorkspaceId

router = APIRouter(prefix="/uploads", tags=["Uploads"])

DISK_FLOOR_BYTES = 256 * 1024**2
FIELDS = ("unit", "name")
_PATCH_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {PATCH_MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}},
    },
    "parameters": [
        {"name": name, "in": "header", "required": required, "schema": {"type": "string"}, "description": said}
        for name, required, said in (
            ("Tus-Resumable", True, VERSION),
            ("Upload-Offset", True, "Bytes the server has"),
            ("Upload-Checksum", False, f"Of this request: one of {', '.join(ALGORITHMS)}, and Base64"),
        )
    ],
}
_CREATE: dict[str, Any] = {
    "parameters": [
        {"name": name, "in": "header", "required": required, "schema": {"type": "string"}, "description": said}
        for name, required, said in (
            ("Tus-Resumable", True, VERSION),
            ("Upload-Length", True, "Bytes of the file"),
            ("Upload-Metadata", False, "`filename`, `unit` and `name`, each with its value in Base64"),
        )
    ]
}


@router.options("", operation_id="describeUploads", status_code=204, responses=problems())
def describe_uploads(services: ServicesDep) -> Response:
    """What this server knows of tus."""
    return Response(
        status_code=204,
        headers={
            **HEADERS,
            "Tus-Version": VERSION,
            "Tus-Extension": EXTENSIONS,
            "Tus-Max-Size": str(int(services.settings.upload_limit_bytes)),
            "Tus-Checksum-Algorithm": ",".join(ALGORITHMS),
        },
    )


@router.post(
    "",
    operation_id="createUpload",
    status_code=201,
    dependencies=[Versioned],
    responses=problems(412, 413, 422, 507),
    openapi_extra=_CREATE,
)
def create_upload(request: Request, response: Response, services: ServicesDep, workspace: WorkspaceDep) -> UploadInfo:
    """Announce a file; its bytes come with PATCH requests to the answer's Location."""
    length = number_of(request, "Upload-Length")
    limit = services.settings.upload_limit_bytes
    if length > limit:
        raise LimitError("upload.too_large", f"Uploads may have {limit} bytes at most; this has {length}", limit_bytes=limit)
    free = shutil.disk_usage(services.settings.data_dir).free
    if free < length + DISK_FLOOR_BYTES:
        raise LimitError("storage.full", f"{free} bytes are free, {length} are announced", free_bytes=free, length=length)
    told = metadata_of(request)
    upload = services.uploads.create(
        workspace,
        file_name=plain_name(told.get("filename", "upload")),
        fields={name: told[name] for name in FIELDS if name in told},
        length=length,
    )
    response.headers.update({**HEADERS, "Location": upload_path(upload.id), "Upload-Expires": expires(upload.expires_at)})
    return _describe(request, upload)


@router.head("/{upload_id}", include_in_schema=False, dependencies=[Versioned])
def head_upload(upload_id: UploadId, services: ServicesDep, workspace: WorkspaceDep) -> Response:
    """Where to go on."""
    upload = services.uploads.get(workspace, upload_id)
    return Response(status_code=200, headers={**_progress(upload), "Upload-Length": str(upload.length)})


@router.get("/{upload_id}", operation_id="getUpload", response_model_exclude_none=True, responses=problems(404))
def get_upload(upload_id: UploadId, request: Request, services: ServicesDep, workspace: WorkspaceDep) -> UploadInfo:
    """How far an upload is, for clients that do not speak tus."""
    return _describe(request, services.uploads.get(workspace, upload_id))


@router.patch(
    "/{upload_id}",
    operation_id="continueUpload",
    status_code=204,
    dependencies=[Versioned],
    responses=problems(404, 409, 412, 413, 415, 422, 423, 460, 507),
    openapi_extra=_PATCH_BODY,
)
async def continue_upload(
    upload_id: UploadId, request: Request, services: ServicesDep, workspace: WorkspaceDep, checksum: ChecksumDep
) -> Response:
    """Send the bytes from `Upload-Offset` on. Those acknowledged survive everything."""
    offset = number_of(request, "Upload-Offset")
    if request.headers.get("content-type") != PATCH_MEDIA_TYPE:
        raise InputError("request.media_type", f"The pieces of an upload are {PATCH_MEDIA_TYPE}")
    receiving = Receiving(services, workspace, upload_id, RequestBody(request), checksum)
    return Response(status_code=204, headers=_progress(await receiving.run(offset)))


@router.delete(
    "/{upload_id}",
    operation_id="terminateUpload",
    status_code=204,
    dependencies=[Versioned],
    responses=problems(404, 412, 423),
)
def terminate_upload(upload_id: UploadId, services: ServicesDep, workspace: WorkspaceDep) -> Response:
    """Forget an upload. What was made of it stays."""
    services.uploads.get(workspace, upload_id)
    with partial_file(services.uploads_dir, upload_id) as file:
        services.uploads.delete(workspace, upload_id)
        file.path.unlink(missing_ok=True)
    return Response(status_code=204, headers=HEADERS)


@router.post(
    "/{upload_id}/mesh",
    operation_id="makeMeshOfUpload",
    status_code=201,
    response_model_exclude_none=True,
    responses=problems(404, 409, 413, 415, 422, 423, 507),
)
async def make_mesh(
    upload_id: UploadId,
    request: Request,
    response: Response,
    services: ServicesDep,
    workspace: WorkspaceDep,
    wanted: Annotated[MeshFromUpload | None, Body()] = None,
) -> MeshInfo:
    """Read a finished upload as a mesh. Asked again, it answers with the same mesh; a file that could not be read stays."""
    work = partial(_read_upload, services, workspace, upload_id, wanted or MeshFromUpload())
    record = await anyio.to_thread.run_sync(work, limiter=services.intake_slots)
    response.headers["Location"] = mesh_path(record.id)
    return describe_mesh(request, record)


def _read_upload(services: Services, workspace: WorkspaceId, upload_id: str, wanted: MeshFromUpload) -> MeshRecord:
    if (made := services.uploads.get(workspace, upload_id).mesh_id) is not None:
        return services.meshes.get(workspace, made)
    with locked_upload(services, workspace, upload_id) as locked:
        if locked.upload.mesh_id is not None:  # another request was quicker
            locked.forget()
            return services.meshes.get(workspace, locked.upload.mesh_id)
        received = locked.read(wanted.model_dump(exclude_none=True))
        record = services.meshes.create(
            workspace,
            parse(services, received, require_unit(received), locked.folder),
            reserved_bytes=received.size,
            also=lambda mesh, session: services.uploads.finish(workspace, upload_id, mesh.id, session=session),
        )
        locked.forget()  # the blobs have it; the row stays, so that asking again finds the mesh
        return record


def _progress(upload: Upload) -> dict[str, str]:
    return {**HEADERS, "Upload-Offset": str(upload.received), "Upload-Expires": expires(upload.expires_at)}


def _describe(request: Request, upload: Upload) -> UploadInfo:
    path = upload_path(upload.id)
    links = [link(request, path, "self", title="Upload")]
    if upload.mesh_id is not None:
        links.append(link(request, mesh_path(upload.mesh_id), "related", title="Mesh"))
    return UploadInfo(
        id=upload.id,
        file_name=upload.file_name,
        length=upload.length,
        received=upload.received,
        mesh=upload.mesh_id,
        created=upload.created_at,
        expires=upload.expires_at,
        links=tuple(links),
    )
