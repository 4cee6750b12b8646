"""The commands about jobs that are there already."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import typer

from integument.cli.app import options_of
from integument.cli.job_run import Wanted, conclude, see_to_end
from integument.cli.job_table import job_lines, job_table
from integument.cli.session import connect
from integument.errors import ArgumentError
from integument.event import JobEvent

JobArgument: TypeAlias = Annotated[str, typer.Argument(metavar="ID", help="Job id.")]
StatusName = Literal["accepted", "running", "successful", "failed", "dismissed"]


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command()(jobs)
    app.command()(job)
    app.command()(logs)
    app.command()(cancel)
    app.command()(retry)
    app.command()(report)
    app.command()(download)


def jobs(
    ctx: typer.Context,
    status: Annotated[StatusName | None, typer.Option(help="Only these.")] = None,
    process: Annotated[str | None, typer.Option(help="Only jobs of this process.")] = None,
    label: Annotated[
        list[str] | None, typer.Option(metavar="LABEL", help="Only jobs with this label; repeat for several.")
    ] = None,
    search: Annotated[str, typer.Option(metavar="WORDS", help="Only jobs in whose name, labels, meshes or id they occur.")] = "",
    limit: Annotated[int, typer.Option(min=1, help="At most so many, the newest first.")] = 20,
) -> None:
    """List jobs."""
    options = options_of(ctx)
    with connect(options) as session:
        found = list(session.client.jobs(status=status, process=process, labels=label or (), text=search, limit=limit))
    options.screen.document([item.as_json() for item in found])
    options.screen.show(job_table(found))


def job(ctx: typer.Context, job_id: JobArgument) -> None:
    """Show one job."""
    options = options_of(ctx)
    with connect(options) as session:
        found = session.client.job(job_id)
    options.screen.document(found.as_json())
    for line in job_lines(found):
        options.screen.show(line)


def logs(
    ctx: typer.Context,
    job_id: JobArgument,
    follow: Annotated[bool, typer.Option("--follow", "-f", help="Go on to the end of the job.")] = False,
) -> None:
    """Print what happened to a job; with --json a list of its events."""
    options = options_of(ctx)
    seen: list[JobEvent] = []
    with connect(options) as session:
        for event in session.client.events(job_id, follow=follow):
            seen.append(event)
            options.screen.show(event_line(event))
    options.screen.document([{"id": event.id, "event": event.type, **event.data} for event in seen])


def cancel(ctx: typer.Context, job_id: JobArgument) -> None:
    """Dismiss a waiting or running job."""
    options = options_of(ctx)
    with connect(options) as session:
        dismissed = session.client.dismiss(job_id)
    options.screen.document(dismissed.as_json())
    options.screen.show(f"job {dismissed.id}: {dismissed.message or dismissed.status}")


def retry(ctx: typer.Context, job_id: JobArgument) -> None:
    """Run a failed or dismissed job once more, and watch it to its end."""
    options = options_of(ctx)
    with connect(options) as session:
        raise typer.Exit(see_to_end(session, options, session.client.retry(job_id), Wanted()))


def report(
    ctx: typer.Context,
    job_id: JobArgument,
    output: Annotated[Path | None, typer.Option("--output", "-o", dir_okay=False, help="Where to put the HTML page.")] = None,
) -> None:
    """Show a finished job's report; failed jobs have one too. Exits as the job's own command would have."""
    options = options_of(ctx)
    wanted = Wanted(report_html=output)
    wanted.require_room()
    with connect(options) as session:
        found = session.client.job(job_id)
        if not found.done:
            raise ArgumentError(f"job {found.id} is still {found.status}")
        raise typer.Exit(conclude(session, options.screen, found, wanted))


def download(
    ctx: typer.Context,
    job_id: JobArgument,
    output: Annotated[str, typer.Argument(metavar="OUTPUT", help="Name of the output: package, report, skin, fat, ...")],
    target: Annotated[Path, typer.Argument(metavar="[FILE]", help="File or folder.")] = Path(),
) -> None:
    """Fetch an output, going on where a broken call stopped; checked against the server's SHA-256."""
    options = options_of(ctx)
    with connect(options) as session:
        view = options.progress_view()
        with view:
            path = session.client.download(job_id, output, target, on_bytes=view.transfer(f"download {output}"))
    options.screen.document({"output": output, "file": str(path), "size_bytes": path.stat().st_size})
    options.screen.show(str(path))


def event_line(event: JobEvent) -> str:
    """One event for people."""
    percent = "" if event.progress is None else f"{event.progress:.0f} %"
    words = (percent, str(event.data.get("status") or ""), event.phase, event.message)
    return f"{event.type:<9}{'  '.join(word for word in words if word)}"
