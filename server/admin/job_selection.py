"""Options that say which jobs are meant."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

from core.errors import InputError
from server.admin.arguments import positive_days
from store.all_jobs import AllJobs
from store.job import Job, JobStatus
from store.job_selector import JobSelector
from store.workspace import WorkspaceId

PAGE = 200


def add_filters(command: argparse.ArgumentParser) -> None:
    """Which workspaces, processes, failures and ages."""
    command.add_argument("--workspace", action="append", default=[], metavar="NAME", help="of this one; repeat")
    command.add_argument("--process", action="append", default=[], metavar="ID", help="of this process; repeat")
    command.add_argument("--code", default=None, metavar="CODE", help="failed with this code, as `worker.lost`")
    command.add_argument(
        "--older-than",
        type=positive_days,
        default=None,
        metavar="DAYS",
        help="ended longer ago, or accepted if it has not ended",
    )


def read_filters(options: argparse.Namespace, statuses: Sequence[JobStatus]) -> JobSelector:
    """What the options select among jobs of these statuses."""
    return JobSelector(
        statuses=tuple(statuses),
        workspaces=tuple(map(WorkspaceId, options.workspace)),
        processes=tuple(options.process),
        code=options.code,
        older_than=options.older_than,
    )


def select_jobs(jobs: AllJobs, options: argparse.Namespace, statuses: Sequence[JobStatus]) -> tuple[Job, ...]:
    """Those named, or those the filters select. Raises InputError `admin.nothing_selected`, StateError `job.not_found`."""
    selector = read_filters(options, statuses)
    if options.id:
        if not selector.is_everything:
            raise InputError("admin.nothing_selected", "name jobs, or select them by options, not both")
        return tuple(map(jobs.get, dict.fromkeys(options.id)))
    if selector.is_everything:
        raise InputError("admin.nothing_selected", "name jobs, or select them by --code, --workspace, --process or --older-than")
    return tuple(_all(jobs, selector))


def _all(jobs: AllJobs, selector: JobSelector) -> Iterator[Job]:
    cursor: str | None = None
    while True:
        page = jobs.list(selector, limit=PAGE, cursor=cursor)
        yield from page.items
        if (cursor := page.next) is None:
            return
