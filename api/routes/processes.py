"""The catalogue, and the way in: execution."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Request, Response
from sqlalchemy.orm import Session
from starlette.concurrency import run_in_threadpool

from api.access import WorkspaceDep
from api.execution import find_and_read, resolve_meshes
from api.idempotency import REPLAYED, Once, fingerprint_of
from api.job_documents import describe_job
from api.links import BASE, job_path
from api.outlook import Outlook
from api.parameters import IdempotencyKey, PreferencesDep
from api.process_documents import describe_process, find_process, list_processes
from api.responses import problems
from api.schemas.execution import ExecuteRequest
from api.schemas.job import StatusInfo
from api.schemas.process import Process, ProcessList
from api.services import Services, ServicesDep
from api.sizing import size_up
from api.subscription import read_subscriber
from api.waiting import has_ended, wait_until
from store.callback import Subscriber
from store.idempotency import Reply
from store.job import Job
from store.job_words import JobWords
from store.workspace import WorkspaceId

router = APIRouter(prefix="/processes", tags=["Processes"])


@router.get("", operation_id="listProcesses", response_model_exclude_none=True, responses=problems())
def get_processes(request: Request) -> ProcessList:
    """What this server can do."""
    return list_processes(request)


@router.get("/{process_id}", operation_id="getProcess", response_model_exclude_none=True, responses=problems(404))
def get_process(process_id: str, request: Request) -> Process:
    """One process with the schema of every input."""
    return describe_process(request, find_process(process_id))


@router.post(
    "/{process_id}/execution",
    operation_id="executeProcess",
    status_code=201,
    response_model=StatusInfo,
    response_model_exclude_none=True,
    responses=problems(404, 409, 413, 415, 422),
)
async def execute_process(
    process_id: str,
    body: Annotated[ExecuteRequest, Body()],
    request: Request,
    services: ServicesDep,
    workspace: WorkspaceDep,
    preferences: PreferencesDep,
    idempotency_key: IdempotencyKey = None,
) -> Response:
    """Accept a job and answer at once, or with `Prefer: wait=N` when it ends; follow Location for progress."""
    subscriber = read_subscriber(services, request, body.subscriber)
    asked = (workspace, process_id, body, subscriber, idempotency_key)
    job, replayed, outlook = await run_in_threadpool(_accept, services, *asked)
    if preferences.wait_s:
        job = await wait_until(services, job, preferences.wait_s, has_ended)
        outlook = await run_in_threadpool(services.outlooks.of, job)
    headers = {"Location": job_path(job.id), **preferences.applied(), **({REPLAYED: "true"} if replayed else {})}
    told = describe_job(request, job, outlook).model_dump_json(exclude_none=True)
    return Response(told, status_code=201, headers=headers, media_type="application/json")


def _accept(
    services: Services,
    workspace: WorkspaceId,
    process_id: str,
    body: ExecuteRequest,
    subscriber: Subscriber | None,
    key: str | None,
) -> tuple[Job, bool, Outlook]:
    """The job, whether an earlier request with this key made it, and what it may expect."""
    process, inputs = find_and_read(process_id, body)
    path = f"{BASE}/processes/{process_id}/execution"
    once = Once(services, workspace, key, fingerprint_of("POST", path, body.identity()))

    def accept() -> Job:
        stored, meshes = resolve_meshes(services, workspace, inputs)
        expectation = size_up(services, process.id, stored, meshes)

        def write(session: Session) -> Job:
            job = services.jobs.create(
                workspace,
                process.id,
                stored,
                mesh_inputs=meshes,
                max_attempts=services.settings.max_attempts + process.more_attempts,
                subscriber=subscriber,
                expectation=expectation,
                words=JobWords(body.name, body.labels),
                session=session,
            )
            once.keep(Reply(201, {"Location": job_path(job.id)}, {"job": job.id}), session)
            return job

        job = services.commits.run(write, workspace)
        services.ringer.ring(job)
        return job

    job, replayed = once.answer(accept, lambda kept: services.jobs.get(workspace, str(kept["job"])))
    return job, replayed, services.outlooks.of(job) if replayed else services.outlooks.of_accepted(job)
