"""One job from the request to its verdict on the screen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import typer

from integument.cli.exit_code import ExitCode
from integument.cli.progress import ProgressView
from integument.cli.screen import Screen
from integument.cli.session import Options, Session
from integument.cli.verdict_table import comparison_table, finding_lines, mesh_table, verdict_line
from integument.errors import ArgumentError, JobError, ProblemError
from integument.job import Job
from integument.report import Report

NO_REPORT = "job.no_report"


@dataclass(frozen=True, slots=True)
class Wanted:
    """What to keep of a job: output -> file or folder, and where its report for people goes."""

    outputs: Mapping[str, Path] = field(default_factory=dict)
    report_html: Path | None = None

    @classmethod
    def of(cls, report_html: Path | None, **outputs: Path | None) -> Wanted:
        """Of outputs without a place nothing is kept."""
        return cls({name: path for name, path in outputs.items() if path is not None}, report_html)

    def require_room(self) -> None:
        """Raises: ArgumentError if a folder is missing, before hours of work are spent."""
        for path in [*self.outputs.values(), *([self.report_html] if self.report_html else [])]:
            if not path.absolute().parent.is_dir():
                raise ArgumentError(f"cannot write {path}: the folder {path.absolute().parent} does not exist")


def watch(session: Session, screen: Screen, view: ProgressView, job: Job) -> Job:
    """The job when it is over, however it ended. Ctrl-C dismisses it if its server goes with this call.

    Raises: typer.Exit with code 130 after Ctrl-C.
    """
    try:
        return session.client.wait(job, view.on_event)
    except JobError as error:
        return error.job
    except KeyboardInterrupt:
        if session.ends_with_call:
            session.client.dismiss(job)
            screen.note(f"job {job.id} was dismissed")
        else:
            screen.note(f"job {job.id} goes on; see it with `integument logs {job.id} --follow`")
        raise typer.Exit(ExitCode.INTERRUPTED) from None


def conclude(session: Session, screen: Screen, job: Job, wanted: Wanted) -> ExitCode:
    """Fetch what is wanted of a finished job and show how it ended."""
    report = fetch_report(session, job)
    there = {name: path for name, path in wanted.outputs.items() if job.status == "successful" or name in job.left}
    files = {name: str(session.client.download(job, name, path)) for name, path in there.items()}
    if wanted.report_html is not None and report is not None:
        wanted.report_html.write_text(session.client.report_html(job), encoding="utf-8")
        files["report_html"] = str(wanted.report_html)
    code = ExitCode.READY if job.ready else ExitCode.NOT_READY
    screen.document(
        {"job": job.as_json(), "report": report.as_json() if report else None, "files": files, "exit_code": int(code)}
    )
    _show(screen, job, report, files)
    return code


def fetch_report(session: Session, job: Job) -> Report | None:
    """None if the job ended before there was anything to report."""
    try:
        return session.client.report(job)
    except ProblemError as error:
        if error.code == NO_REPORT or error.status == 404:
            return None
        raise


def _show(screen: Screen, job: Job, report: Report | None, files: Mapping[str, str]) -> None:
    if report is not None:
        if job.status == "successful":
            screen.show(verdict_line(report, job.seconds))
        if report.meshes:
            screen.show(mesh_table(report))
        if report.comparisons:
            screen.show(comparison_table(report))
        for line in finding_lines(report.findings):
            screen.show(line)
    for name, path in files.items():
        screen.show(f"{name}: {path}")
    if job.status == "failed":
        failure = job.failure
        screen.note(f"job {job.id} failed: {f'{failure.code}: {failure.message}' if failure else job.message or ''}")
        if job.left:
            screen.note(f"left: {', '.join(job.left)}; fetch one with `integument download {job.id} {next(iter(job.left))}`")
    elif job.status == "dismissed":
        screen.note(f"job {job.id} was dismissed")
    else:
        screen.note(f"job {job.id}")


def run_to_end(session: Session, options: Options, process: str, inputs: Mapping[str, Any], wanted: Wanted) -> ExitCode:
    """Queue the job, watch it, and conclude when the bar is gone."""
    words = options.words
    job = session.client.execute(process, inputs, name=words.name, labels=words.labels)
    return see_to_end(session, options, job, wanted)


def see_to_end(session: Session, options: Options, job: Job, wanted: Wanted) -> ExitCode:
    """Watch a job that is queued already, and conclude."""
    view = options.progress_view()
    with view:
        finished = watch(session, options.screen, view, job)
    return conclude(session, options.screen, finished, wanted)
