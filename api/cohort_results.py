"""What a cohort made: the summary, and one zip of what its jobs made."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial

from starlette.requests import Request

from api.cohort_documents import cohort_path
from api.links import absolute, job_path
from api.outcome import require_results
from api.schemas.job import ResultReference, Results
from api.services import Services
from api.streamed_zip import StoredFile
from core.errors import StateError
from store.cohort import Cohort
from store.job import Job, JobOutput
from store.workspace import WorkspaceId

PACKAGES = "packages"
MAIN_OUTPUTS = ("package", "mesh", "msh", "report")  # of a job, the first it has
_UNSAFE = re.compile(r"[^A-Za-z0-9 ._=-]+")


def require_summary(services: Services, workspace: WorkspaceId, cohort: Cohort) -> Job:
    """The successful job of the summary.

    Raises StateError `result.not_ready` while subjects or it are under way, else what it failed of."""
    if cohort.finished_at is None or cohort.summary_job_id is None:
        raise StateError("result.not_ready", f"{cohort.live} jobs of cohort {cohort.id} wait or run", cohort=cohort.id)
    return require_results(services.jobs.get(workspace, cohort.summary_job_id))


def refer_to_cohort(request: Request, cohort: Cohort, summary: Job) -> Results:
    """Every output of the summary by reference, and the zip."""
    told = {
        name: ResultReference(
            href=absolute(request, f"{job_path(summary.id)}/results/{name}"), type=output.media_type, title=output.file_name
        )
        for name, output in summary.outputs.items()
    }
    href = absolute(request, f"{cohort_path(cohort.id)}/results/{PACKAGES}")
    told[PACKAGES] = ResultReference(href=href, type="application/zip", title=f"{PACKAGES}.zip")
    return Results(told)


def files_of(services: Services, jobs: tuple[Job, ...], wanted: str | None) -> Iterator[StoredFile]:
    """`subject/file` of every job that has it, in the order of the request; names are told apart by numbers."""
    taken: set[str] = set()
    for job in jobs:
        output = _chosen(job, wanted)
        if output is None:
            continue
        folder = _UNSAFE.sub("_", job.subject or job.id).strip(". ")[:100] or "subject"
        name, number = folder, 1
        while name.casefold() in taken:
            number += 1
            name = f"{folder}_{number}"
        taken.add(name.casefold())
        yield StoredFile(f"{name}/{output.file_name}", output.size, partial(services.blobs.open, output.sha256))


def _chosen(job: Job, wanted: str | None) -> JobOutput | None:
    names = (wanted,) if wanted is not None else MAIN_OUTPUTS
    return next((job.outputs[name] for name in names if name in job.outputs), None)
