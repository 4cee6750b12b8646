"""What a job was asked for, to look at, to compare, and to ask again with something changed."""

from __future__ import annotations

from fastapi import APIRouter

from api.access import WorkspaceDep
from api.parameters import JobId
from api.responses import problems
from api.schemas.inputs import JobInputs
from api.services import ServicesDep

router = APIRouter(prefix="/jobs/{job_id}/inputs", tags=["Jobs"])


@router.get("", operation_id="getJobInputs", responses=problems(404))
def get_inputs(job_id: JobId, services: ServicesDep, workspace: WorkspaceDep) -> JobInputs:
    """The process and its inputs. The meshes behind the links may have been deleted since."""
    job = services.jobs.get(workspace, job_id)
    return JobInputs(process_id=job.process, inputs=dict(job.inputs))
