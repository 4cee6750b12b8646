"""What a job made: the document of references, the files, and the report."""

from __future__ import annotations

import json
import pathlib
from collections.abc import Callable
from functools import partial
from typing import Annotated, Any

import anyio
from fastapi import APIRouter, Path, Request
from fastapi.responses import JSONResponse
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from api.access import WorkspaceDep
from api.downloads import Download, send_download
from api.job_documents import REPORT_HTML_OUTPUT, REPORT_OUTPUT, describe_failure, refer_to_results
from api.links import job_path
from api.mesh_export import WRITTEN_AS, StoredMesh, export_field, export_mesh
from api.negotiation import prefers
from api.outcome import no_such_output, require_results, tell_failure
from api.parameters import JobId, MostFaces
from api.responses import files, problems
from api.schemas.job import Results
from api.schemas.job_report import ReportedJob
from api.scratch import FolderDep
from api.services import Services, ServicesDep
from api.stored_download import stored_download
from core.errors import StateError
from store.job import Job, JobOutput, JobStatus
from store.mesh_inputs import count_faces
from store.workspace import WorkspaceId

router = APIRouter(prefix="/jobs/{job_id}", tags=["Results"])

# The report shows its surfaces by a script of its own, which its own policy names by checksum. Here it may run, but as nobody:
# the sandbox gives it an origin without cookies, storage or access to this server, and nothing may be asked of any other.
REPORT_POLICY = (
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'; sandbox allow-scripts allow-downloads"
)


@router.get("/results", operation_id="getResults", response_model=Results, responses=problems(404, 409, 413, 422))
def get_results(job_id: JobId, request: Request, services: ServicesDep, workspace: WorkspaceDep) -> Results | Response:
    """Every output of a successful job, by reference.

    A failed job answers with the problem it failed of, whose `outputs` are those it left: its report, and of `prepare` the
    surfaces as the last finished step left them."""
    job = services.jobs.get(workspace, job_id)
    if job.status is JobStatus.FAILED and job.failure is not None:
        return tell_failure(request, job, job.failure)
    return refer_to_results(request, require_results(job))


FACES_HEADER = "Integument-Faces"
STL_MEDIA_TYPE = WRITTEN_AS["stl"][0]
FIELDS, FIELD = "fields", "msh"  # the process whose output of this name has a field on triangles


@router.head("/results/{output}", include_in_schema=False)
@router.get(
    "/results/{output}",
    operation_id="getResult",
    response_class=Response,
    responses=files("The output", "application/zip", "application/json", "text/html", "model/stl") | problems(409, 413, 422),
)
async def get_result(
    job_id: JobId,
    output: Annotated[str, Path(description="Name of the output")],
    request: Request,
    services: ServicesDep,
    workspace: WorkspaceDep,
    folder: FolderDep,
    most_faces: MostFaces = None,
) -> Response:
    """One output as a file. A failed job may have left some too: the problem of its results lists them.

    A surface with more than `most_faces` comes coarser, and the header `Integument-Faces` says how many it really has. `msh` of
    `fields` comes coarser, too: magnitudes alone, at most so many triangles in all, each with that of the one it stands for."""
    job, found = await run_in_threadpool(_find_output, services, workspace, job_id, output)
    coarser = None if most_faces is None else _coarser(services, job, output, found, most_faces, folder)
    if coarser is None:
        return send_download(request, await run_in_threadpool(_download, services, found))
    download = await anyio.to_thread.run_sync(coarser, limiter=services.intake_slots)
    headers = {FACES_HEADER: str(count_faces(found))} if found.media_type == STL_MEDIA_TYPE else {}
    return send_download(request, download, extra_headers=headers)


def _coarser(
    services: Services, job: Job, output: str, found: JobOutput, most_faces: int, folder: pathlib.Path
) -> Callable[[], Download] | None:
    """How to make it; None where it goes out as it is."""
    stored = StoredMesh(found.sha256, found.media_type, found.file_name, pathlib.PurePath(found.file_name).stem)
    if (job.process, output) == (FIELDS, FIELD):
        return partial(export_field, services, stored, most_faces, folder)
    if found.media_type == STL_MEDIA_TYPE and count_faces(found) > most_faces:
        return partial(export_mesh, services, stored, "stl", most_faces, folder)
    return None


def _find_output(services: Services, workspace: WorkspaceId, job_id: str, output: str) -> tuple[Job, JobOutput]:
    job = services.jobs.get(workspace, job_id)
    found = job.outputs.get(output)
    if found is None:
        raise no_such_output(require_results(job), output)
    return job, found


@router.head("/report", include_in_schema=False)
@router.get(
    "/report",
    operation_id="getReport",
    response_class=Response,
    responses={
        200: {
            "description": "The report; JSON adds `job` and `timings_s`, which are not part of the result",
            "content": {"application/json": {"schema": {"$ref": "#/components/schemas/JobReport"}}, "text/html": {}},
        },
        **problems(404),
    },
)
def get_report(job_id: JobId, request: Request, services: ServicesDep, workspace: WorkspaceDep) -> Response:
    """The report of a successful or failed job, for programs (JSON) or people (HTML), as `Accept` asks."""
    job = services.jobs.get(workspace, job_id)
    as_html = prefers(request.headers.get("accept"), "text/html", "application/json")
    found = job.outputs.get(REPORT_HTML_OUTPUT if as_html else REPORT_OUTPUT)
    if found is None:
        raise StateError("job.no_report", f"job {job.id} is {job.status} and has no report", job=job.id, status=job.status.value)
    if as_html:
        download = _download(services, found, inline=True)
        return send_download(request, download, extra_headers={"Content-Security-Policy": REPORT_POLICY, "Vary": "Accept"})
    with services.blobs.open(found.sha256) as file:
        report: dict[str, Any] = json.load(file)
    about = _about(job).model_dump(mode="json")
    return JSONResponse({**report, "job": about, "timings_s": dict(job.timings_s)}, headers={"Vary": "Accept"})


def _about(job: Job) -> ReportedJob:
    return ReportedJob(
        id=job.id,
        href=job_path(job.id),
        process=job.process,
        status=job.status.value,
        attempt=job.attempt,
        created=job.created_at,
        started=job.started_at,
        finished=job.finished_at,
        peak_memory_bytes=job.peak_memory_bytes,
        failure=describe_failure(job),
    )


def _download(services: Services, output: JobOutput, *, inline: bool = False) -> Download:
    return stored_download(
        services.blobs, output.sha256, output.size, file_name=output.file_name, media_type=output.media_type, inline=inline
    )
