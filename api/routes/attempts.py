"""What is known of the attempts of a job that were lost."""

from __future__ import annotations

from fastapi import APIRouter

from api.access import WorkspaceDep
from api.parameters import JobId
from api.responses import problems
from api.schemas.attempt import LostAttemptInfo, LostAttemptList
from api.services import ServicesDep
from store.lost_attempt import LostAttempt

router = APIRouter(prefix="/jobs/{job_id}/attempts", tags=["Jobs"])


@router.get("", operation_id="listLostAttempts", response_model_exclude_none=True, responses=problems(404))
def get_attempts(job_id: JobId, services: ServicesDep, workspace: WorkspaceDep) -> LostAttemptList:
    """The attempts that took down their worker or child: who, where, how, and the end of the log."""
    return LostAttemptList(attempts=tuple(_describe(one) for one in services.parked.attempts(workspace, job_id)))


def _describe(attempt: LostAttempt) -> LostAttemptInfo:
    return LostAttemptInfo(
        attempt=attempt.attempt,
        worker=attempt.worker,
        code=attempt.code,
        message=attempt.message,
        signal=attempt.signal,
        phase=attempt.phase,
        progress=attempt.progress,
        peak_memory_bytes=attempt.peak_memory_bytes,
        log=attempt.log,
        started=attempt.started_at,
        ended=attempt.ended_at,
    )
