"""Counts, in the tables, the blobs, the scratch folders and the processes themselves, what became of every job."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

import psutil
from sqlalchemy import select

from store.database import Database
from store.job import JobStatus
from store.jobs import Jobs
from store.open_blobs import open_blobs
from store.records import EventRow, JobRow
from store.references import References
from tests.acceptance.faults.plan import HOSTS
from tests.acceptance.faults.premises import Premises
from tests.acceptance.faults.story import Story
from tests.children import children_at_work
from worker.job_folder import sweep_job_folders

FINISHED = frozenset({JobStatus.SUCCESSFUL, JobStatus.FAILED, JobStatus.DISMISSED})
STUMBLED = ("in a way nobody foresaw", "nobody foresaw", "stumbled", "internal.unexpected")  # words of a bug, in a log


@dataclass
class Census:
    """Every list and number named in `wrong` has to be empty or 0."""

    requests: int = 0
    accepted: int = 0
    by_status: Counter[str] = field(default_factory=Counter)
    by_attempts: Counter[int] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)
    stuck: list[str] = field(default_factory=list)
    taken_twice: list[str] = field(default_factory=list)
    finished_twice: list[str] = field(default_factory=list)
    wrong_bytes: list[str] = field(default_factory=list)
    undismissed: list[str] = field(default_factory=list)
    event_gaps: list[str] = field(default_factory=list)
    missing_blobs: list[str] = field(default_factory=list)
    left_blobs: int = 0
    left_folders: list[str] = field(default_factory=list)
    left_processes: list[str] = field(default_factory=list)
    stumbles: list[str] = field(default_factory=list)
    client_errors: list[str] = field(default_factory=list)
    requeued_s: list[float] = field(default_factory=list)
    recovered_s: list[float] = field(default_factory=list)

    def wrong(self) -> dict[str, list[str]]:
        """What must not be, by name."""
        return {
            "lost": self.lost,
            "stuck": self.stuck,
            "taken twice": self.taken_twice,
            "finished twice": self.finished_twice,
            "wrong bytes": self.wrong_bytes,
            "failed": self.failures,
            "dismissed in vain": self.undismissed,
            "gaps in events": self.event_gaps,
            "blobs missing": self.missing_blobs,
            "folders left": self.left_folders,
            "processes left": self.left_processes,
            "stumbled": self.stumbles,
            "errors of clients": self.client_errors,
        }


def unfinished(premises: Premises, jobs: Iterable[str]) -> list[str]:
    """Those of `jobs` that are not finished now."""
    database = Database(premises.direct)
    try:
        with database.reading() as session:
            finished = set(session.scalars(select(JobRow.id).where(JobRow.status.in_(FINISHED))))
    finally:
        database.close()
    return [job for job in jobs if job not in finished]


def count_jobs(
    census: Census,
    premises: Premises,
    stories: Iterable[Story],
    expected: Mapping[int, Mapping[str, str]],
    known: Iterable[str],
) -> None:
    """`expected`: digests of the undisturbed run by variant. `known`: jobs that are not of the plan."""
    database = Database(premises.direct)
    try:
        with database.reading() as session:
            asked = select(JobRow.id, JobRow.process, JobRow.status, JobRow.phase, JobRow.attempt, JobRow.message, JobRow.failure)
            rows = {row.id: row for row in session.execute(asked)}
            ends = Counter(session.scalars(select(EventRow.job_id).where(EventRow.type == "done")))
    finally:
        database.close()
    told = {story.job: story for story in stories if story.is_accepted}
    census.requests = len(list(stories))
    census.accepted = len(told)
    census.taken_twice = [job for job in rows if job not in told and job not in set(known)]
    for job, story in told.items():
        row = rows.get(job)
        if row is None:
            census.lost.append(job)
            continue
        census.by_status[row.status] += 1
        census.by_attempts[row.attempt] += 1
        census.event_gaps += story.gaps
        if row.status not in FINISHED:
            census.stuck.append(f"{job} {row.status} {row.phase} attempt {row.attempt}: {row.message}")
        elif ends[job] != 1:
            census.finished_twice.append(f"{job}: {ends[job]} terminal events")
        if row.status == JobStatus.FAILED:
            failure = row.failure or {}
            census.failures.append(f"{job} {row.process} {failure.get('code')} after {row.attempt}: {failure.get('message')}")
        if row.status == JobStatus.DISMISSED and not story.dismissed:
            census.undismissed.append(f"{job}: nobody asked for it")
        if row.status == JobStatus.SUCCESSFUL and story.sha256 != dict(expected[story.request.variant]):
            census.wrong_bytes.append(
                f"{job} {row.process}: {sorted(set(story.sha256.items()) ^ set(expected[story.request.variant].items()))}"
            )


def measure_recoveries(census: Census, premises: Premises, robbed: Iterable[tuple[str, datetime]]) -> None:
    """From the kill of a worker until its job waits again, and until somebody else has it."""
    database = Database(premises.direct)
    try:
        with database.reading() as session:
            for job, killed_at in robbed:
                query = select(EventRow).where(EventRow.job_id == job, EventRow.at > killed_at).order_by(EventRow.seq)
                told = [(event.data.get("status"), (event.at - killed_at).total_seconds()) for event in session.scalars(query)]
                census.requeued_s += [at_s for status, at_s in told if status == JobStatus.ACCEPTED][:1]
                census.recovered_s += [at_s for status, at_s in told if status == JobStatus.RUNNING][:1]
    finally:
        database.close()


def look_for_leftovers(census: Census, premises: Premises) -> None:
    """After all jobs are finished, the sweeps must be able to take everything that is nobody's, and nothing else."""
    database = Database(premises.direct)
    try:
        jobs, blobs, referenced = Jobs(database), open_blobs(premises.direct, database), References(database).all()
        for host in HOSTS:
            sweep_job_folders(premises.disk(host) / "scratch", jobs, older_than_s=0.0)
            census.left_folders += [str(folder) for folder in (premises.disk(host) / "scratch" / "jobs").glob("*")]
        census.left_blobs = len(blobs.sweep(referenced, older_than_s=0.0))
        census.missing_blobs = sorted(referenced - {blob.sha256 for blob in blobs.all()})
    finally:
        database.close()
    census.left_processes = _find_processes(premises)


def _find_processes(premises: Premises) -> list[str]:
    """Children at work though no job runs, and processes in our folder that belong to no member."""
    members = {premises.member(host).process.pid for host in ("api", *HOSTS)}
    family = {os.getpid(), *members}
    left = []
    for pid in members:
        member = psutil.Process(pid)
        family.update(process.pid for process in member.children(recursive=True))
        left += [f"child {child.pid} of {pid}" for child in children_at_work(member).values()]
    for process in psutil.process_iter(["pid", "cwd"]):
        cwd = process.info["cwd"] or ""
        if process.info["pid"] not in family and Path(cwd).is_relative_to(premises.folder):
            left.append(f"process {process.info['pid']} in {cwd}")
    return left


def read_stumbles(premises: Premises) -> list[str]:
    """Lines of the logs that tell of a bug."""
    return [
        f"{host}: {line[:300]}"
        for host in ("api", *HOSTS)
        for line in premises.member(host).log.read_text(errors="replace").splitlines()
        if any(word in line for word in STUMBLED)
    ]
