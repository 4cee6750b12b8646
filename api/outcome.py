"""What a job without results has instead: a reason."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response

from api.job_documents import refer_to_outputs
from api.problems import problem_of, problem_response
from core.errors import CLASSES_BY_FAULT, IntegumentError, StateError
from core.schema.finding import Finding
from store.job import Job, JobFailure, JobStatus


def revive_failure(failure: JobFailure) -> IntegumentError:
    """The error a job failed of; its class says whose fault it was and so which status its results answer with."""
    findings = tuple(Finding.model_validate(finding) for finding in failure.findings)
    error = CLASSES_BY_FAULT[failure.fault](failure.code, failure.message, findings=findings)
    error.facts = dict(failure.facts)
    return error


def require_results(job: Job) -> Job:
    """The job, if it is successful.

    Raises StateError `result.not_ready` while it is under way, `job.no_results` if it was dismissed, else what it failed of."""
    if job.status is JobStatus.SUCCESSFUL:
        return job
    if job.failure is not None:
        raise revive_failure(job.failure)
    if job.status.is_finished:
        raise StateError("job.no_results", f"job {job.id} is {job.status}, it has no results", job=job.id)
    raise StateError(
        "result.not_ready",
        f"job {job.id} is {job.status} at {job.progress:.0f} %, its results are not ready",
        job=job.id,
        status=job.status.value,
        progress=job.progress,
    )


def tell_failure(request: Request, job: Job, failure: JobFailure) -> Response:
    """The problem a job failed of, with references to the outputs it left all the same."""
    problem = problem_of(request, revive_failure(failure))
    return problem_response(problem.model_copy(update={"outputs": refer_to_outputs(request, job)}))


def no_such_output(job: Job, output: str) -> StateError:
    """The error for an output the job does not have."""
    return StateError(
        "output.not_found", f"job {job.id} has no output {output[:64]!r}; it has {', '.join(job.outputs)}", job=job.id
    )
