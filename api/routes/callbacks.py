"""What a job's subscriber was told."""

from __future__ import annotations

from fastapi import APIRouter

from api.access import WorkspaceDep
from api.parameters import JobId
from api.responses import problems
from api.schemas.callback import CallbackInfo, CallbackList
from api.services import ServicesDep
from store.callback import Callback, CallbackState

router = APIRouter(prefix="/jobs/{job_id}/callbacks", tags=["Jobs"])


@router.get("", operation_id="listCallbacks", response_model_exclude_none=True, responses=problems(404))
def get_callbacks(job_id: JobId, services: ServicesDep, workspace: WorkspaceDep) -> CallbackList:
    """The callbacks of a job; empty if it has no subscriber, or nothing happened yet."""
    return CallbackList(callbacks=tuple(_describe(one) for one in services.callbacks.of_job(workspace, job_id)))


@router.post(
    "/replay", operation_id="replayCallbacks", status_code=202, response_model_exclude_none=True, responses=problems(404)
)
def replay_callbacks(job_id: JobId, services: ServicesDep, workspace: WorkspaceDep) -> CallbackList:
    """Send what was given up once more, from the first attempt on, under the same ids."""
    services.callbacks.replay(workspace, job_id)
    return CallbackList(callbacks=tuple(_describe(one) for one in services.callbacks.of_job(workspace, job_id)))


def _describe(callback: Callback) -> CallbackInfo:
    return CallbackInfo(
        id=callback.id,
        event=callback.event.value,
        uri=callback.uri,
        state=callback.state.value,
        attempts=callback.attempts,
        created=callback.created_at,
        due=callback.due_at if callback.state is CallbackState.PENDING else None,
        ended=callback.ended_at,
        last_status=callback.last_status,
        last_error=callback.last_error,
    )
