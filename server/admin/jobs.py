"""`integument admin jobs`: the jobs of all workspaces."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from typing import Any

from core.errors import StateError
from server.admin.arguments import Subparsers, whole_number
from server.admin.confirmation import add_yes, require_yes
from server.admin.desk import Desk, moment
from server.admin.job_selection import add_filters, read_filters, select_jobs
from store.all_jobs import AllJobs
from store.job import Job, JobStatus
from store.job_selector import FINISHED

COLUMNS = ("id", "workspace", "process", "status", "attempt", "created", "finished", "said")
DONE_COLUMNS = ("id", "workspace", "process", "was", "is")
LIVE = (JobStatus.ACCEPTED, JobStatus.RUNNING)


def register(groups: Subparsers) -> None:
    """Add the commands."""
    commands = groups.add_parser("jobs", help="jobs of all workspaces").add_subparsers(metavar="COMMAND", required=True)

    listing = commands.add_parser("list", help="list them, the newest first")
    listing.add_argument("--status", action="append", choices=list(JobStatus), default=[], help="only these; repeat")
    add_filters(listing)
    listing.add_argument("--limit", type=whole_number, default=50, help="at most so many [%(default)s]")
    listing.add_argument("--cursor", default=None, help="go on where the last page ended")
    listing.set_defaults(run=_list)

    show = commands.add_parser("show", help="everything about one")
    show.add_argument("id", metavar="ID")
    show.set_defaults(run=_show)

    _act(commands.add_parser("dismiss", help="take back waiting and running ones"), "dismiss", LIVE, AllJobs.dismiss)
    retried = (JobStatus.FAILED,)  # by name also dismissed ones; whoever dismissed a job in bulk did not want it
    _act(commands.add_parser("retry", help="queue failed ones again"), "retry", retried, AllJobs.retry)
    _act(commands.add_parser("remove", help="forget finished ones, with their results"), "remove", FINISHED, AllJobs.remove)


def _act(command: ArgumentParser, verb: str, statuses: tuple[JobStatus, ...], act: Callable[[AllJobs, str], Job]) -> None:
    command.add_argument("id", metavar="ID", nargs="*", help="jobs; or select them by the options")
    add_filters(command)
    add_yes(command)
    command.set_defaults(run=lambda desk, options: _do(desk, options, verb, statuses, act))


def _do(desk: Desk, options: Namespace, verb: str, statuses: tuple[JobStatus, ...], act: Callable[[AllJobs, str], Job]) -> None:
    """Named jobs must allow it; of selected ones those that changed meanwhile are left alone, and said."""
    jobs = AllJobs(desk.db)
    selected = select_jobs(jobs, options, statuses)
    if selected and (verb == "remove" or not options.id):
        require_yes(options, f"{verb} {len(selected)} jobs")
    done = []
    for job in selected:
        try:
            after = act(jobs, job.id)
        except StateError as error:
            if options.id:
                raise
            desk.note(f"left alone: {error.message} [{error.code}]")
            continue
        desk.note_act(f"jobs {verb}", job.id, job.workspace)
        is_now = "removed" if verb == "remove" else "being dismissed" if after.dismiss_requested else after.status.value
        done.append({"id": job.id, "workspace": job.workspace, "process": job.process, "was": job.status.value, "is": is_now})
    desk.show_table(DONE_COLUMNS, done)


def _list(desk: Desk, options: Namespace) -> None:
    statuses = [JobStatus(status) for status in options.status]
    page = AllJobs(desk.db).list(read_filters(options, statuses), limit=options.limit, cursor=options.cursor)
    desk.show_table(COLUMNS, [_line(job) for job in page.items])
    if page.next is not None:
        desk.note(f"There are more: --cursor {page.next}")


def _show(desk: Desk, options: Namespace) -> None:
    job = AllJobs(desk.db).get(options.id)
    desk.show(
        {
            **_line(job),
            "phase": job.phase or None,
            "progress": job.progress,
            "message": job.message,
            "max_attempts": job.max_attempts,
            "worker": job.lease_owner,
            "lease_until": moment(job.lease_until),
            "queued": moment(job.queued_at),
            "rung": moment(job.rung_at),
            "started": moment(job.started_at),
            "updated": moment(job.updated_at),
            "verdict": job.verdict,
            "failure": None if job.failure is None else job.failure.describe(),
            "inputs": dict(job.inputs),
            "outputs": {name: output.size for name, output in job.outputs.items()},
            "timings_s": dict(job.timings_s),
            "peak_memory_bytes": job.peak_memory_bytes,
            "events": job.event_seq,
        }
    )


def _line(job: Job) -> dict[str, Any]:
    return {
        "id": job.id,
        "workspace": job.workspace,
        "process": job.process,
        "status": job.status.value,
        "attempt": job.attempt,
        "created": moment(job.created_at),
        "finished": moment(job.finished_at),
        "said": job.failure.code if job.failure is not None else job.verdict,
    }
