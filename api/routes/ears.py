"""The ears of a mesh, to be looked at before a job uses them."""

from __future__ import annotations

from pathlib import Path

import anyio
from fastapi import APIRouter
from starlette.concurrency import run_in_threadpool

from api.access import WorkspaceDep
from api.intake import limits_of, require_mesh
from api.parameters import MeshId
from api.responses import problems
from api.schemas.ears import FoundEars
from api.scratch import FolderDep
from api.services import Services, ServicesDep
from sandbox.call import call
from store.meshes import MeshRecord

router = APIRouter(prefix="/meshes/{mesh_id}", tags=["Meshes"])

TARGET = "core.processes.ear_boxes:run"


@router.get("/ears", operation_id="findEars", responses=problems(404, 413, 422))
async def find_ears(mesh_id: MeshId, services: ServicesDep, workspace: WorkspaceDep, folder: FolderDep) -> FoundEars:
    """The boxes that `ears: "auto"` of the process `ears` would take; 422 `ears.not_found` says what was missing."""
    record = await run_in_threadpool(services.meshes.get, workspace, mesh_id)
    require_mesh(record)
    return await anyio.to_thread.run_sync(_find, services, record, folder, limiter=services.intake_slots)


def _find(services: Services, record: MeshRecord, folder: Path) -> FoundEars:
    canonical = services.blobs.fetch(record.canonical_sha256, folder).absolute()
    told = call(services.nursery, TARGET, {"path": str(canonical)}, limits_of(services), folder, readable=[canonical])
    return FoundEars.model_validate(told)
