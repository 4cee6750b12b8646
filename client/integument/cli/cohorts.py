"""The commands about cohorts: many subjects, one process, one summary."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from integument.cli.app import options_of
from integument.cli.cohort_table import cohort_table, subject_table
from integument.cli.execute import read_inputs
from integument.cli.exit_code import ExitCode
from integument.cli.layer_text import read_layers
from integument.cli.mesh_argument import require_mesh
from integument.cli.mesh_reference import refer_to
from integument.cli.options import LabelOption, LayerOption, NameOption, UnitOption
from integument.cli.screen import Screen
from integument.cli.session import Options, Session, connect
from integument.cohort import Cohort
from integument.errors import ArgumentError

ZipOption = Annotated[Path | None, typer.Option("--output", "-o", dir_okay=False, help="Where to put what all jobs made, a zip.")]
TableOption = Annotated[Path | None, typer.Option(dir_okay=False, help="Where to put the summary table, CSV.")]
PageOption = Annotated[Path | None, typer.Option(dir_okay=False, help="Where to put the summary page, HTML.")]


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command()(cohort)
    app.command()(cohorts)


def cohort(
    ctx: typer.Context,
    subjects: Annotated[
        list[str], typer.Argument(help="Mesh files or /v1/meshes/{id}, one per subject; or one zip of mesh files.")
    ],
    process: Annotated[str, typer.Option(help="What to do with each, see `integument processes`.")],
    inputs: Annotated[Path | None, typer.Option(help="JSON file with the inputs all share; - reads them from stdin.")] = None,
    overrides: Annotated[Path | None, typer.Option(help="JSON file: name of a subject -> inputs of its own.")] = None,
    layer: LayerOption = None,
    subject_input: Annotated[str | None, typer.Option(help="Input that takes the mesh; default skin, mesh, meshes, ...")] = None,
    unit: UnitOption = "mm",
    name: NameOption = None,
    label: LabelOption = None,
    output: ZipOption = None,
    table: TableOption = None,
    report: PageOption = None,
) -> None:
    """Run a process on many subjects, and compare them when all have ended. Ready if every subject is."""
    options = options_of(ctx)
    shared = {} if inputs is None else read_inputs(inputs)
    if layer:
        shared["layers"] = read_layers((), layer)
    more: dict[str, Any] = {
        "overrides": None if overrides is None else _read_overrides(overrides),
        "subject_input": subject_input,
        "name": name,
        "labels": label or (),
    }
    wanted = {"packages": output, "table": table, "report_html": report}
    _require_room(wanted)
    is_archive = len(subjects) == 1 and subjects[0].lower().endswith(".zip")
    named = {} if is_archive else _name_subjects(subjects)
    with connect(options) as session:
        view = options.progress_view()
        with view:
            if is_archive:
                on_bytes = view.transfer(f"upload {Path(subjects[0]).name}")
                made = session.client.create_cohort_of_archive(process, subjects[0], shared, unit=unit, on_bytes=on_bytes, **more)
            else:
                held = {subject: refer_to(session, view, mesh, unit)["href"] for subject, mesh in named.items()}
                made = session.client.create_cohort(process, held, shared, **more)
        raise typer.Exit(_see_to_end(session, options, made, wanted))


def cohorts(
    ctx: typer.Context,
    cohort_id: Annotated[str | None, typer.Argument(metavar="[ID]", help="Show this one.")] = None,
    retry: Annotated[bool, typer.Option("--retry", help="Run its failed and dismissed jobs once more, and wait.")] = False,
    dismiss: Annotated[
        bool, typer.Option("--dismiss", help="Take back what waits or runs; if nothing does, remove it with its results.")
    ] = False,
    limit: Annotated[int, typer.Option(min=1, help="At most so many, the newest first.")] = 20,
    output: ZipOption = None,
    table: TableOption = None,
    report: PageOption = None,
) -> None:
    """List cohorts, or show one: its subjects, and where its results shall go."""
    options = options_of(ctx)
    wanted = {"packages": output, "table": table, "report_html": report}
    _require_room(wanted)
    if cohort_id is None and (retry or dismiss or any(wanted.values())):
        raise ArgumentError("name the cohort; `integument cohorts` lists them")
    if retry and dismiss:
        raise ArgumentError("--retry and --dismiss exclude each other")
    with connect(options) as session:
        if cohort_id is None:
            found = list(session.client.cohorts(limit=limit))
            options.screen.document([item.as_json() for item in found])
            options.screen.show(cohort_table(found))
        elif retry:
            raise typer.Exit(_see_to_end(session, options, session.client.retry_cohort(cohort_id), wanted))
        elif dismiss:
            after = session.client.dismiss_cohort(cohort_id)
            options.screen.document(after.as_json())
            options.screen.show(cohort_table([after]))
        else:
            _conclude(session, options.screen, session.client.cohort(cohort_id), wanted)


def _see_to_end(session: Session, options: Options, made: Cohort, wanted: dict[str, Path | None]) -> ExitCode:
    told = -1

    def tell(now: Cohort) -> None:
        nonlocal told
        ended = now.counts.successful + now.counts.failed + now.counts.dismissed
        if ended != told:
            options.screen.note(f"{now.progress:3.0f} %  {ended} of {now.subjects - now.counts.refused} subjects have ended")
        told = ended

    try:
        finished = session.client.wait_for_cohort(made, tell)
    except KeyboardInterrupt:
        if session.ends_with_call:
            session.client.dismiss_cohort(made)
            options.screen.note(f"cohort {made.id} was dismissed")
        else:
            options.screen.note(f"cohort {made.id} goes on; see it with `integument cohorts {made.id}`")
        raise typer.Exit(ExitCode.INTERRUPTED) from None
    return _conclude(session, options.screen, finished, wanted)


def _conclude(session: Session, screen: Screen, found: Cohort, wanted: dict[str, Path | None]) -> ExitCode:
    jobs = session.client.cohort_jobs(found)
    files = {}
    for name, path in wanted.items():
        if path is not None:
            fetched = (
                session.client.download_packages(found, path)
                if name == "packages"
                else session.client.download_summary(found, name, path)
            )
            files[name] = str(fetched)
    code = ExitCode.READY if found.all_ready else ExitCode.NOT_READY
    document = {"cohort": found.as_json(), "jobs": [job.as_json() for job in jobs], "files": files, "exit_code": int(code)}
    screen.document(document)
    screen.show(subject_table(jobs, found.refused))
    for name, where in files.items():
        screen.show(f"{name}: {where}")
    screen.note(f"cohort {found.id}: {found.status}, {found.ready} of {found.subjects} subjects are ready")
    return code


def _name_subjects(subjects: list[str]) -> dict[str, str]:
    """By their files; links by their own last part."""
    named: dict[str, str] = {}
    for mesh in subjects:
        subject = Path(require_mesh(mesh)).stem
        if subject in named:
            raise ArgumentError(f"{mesh} and {named[subject]} would both be called {subject}")
        named[subject] = mesh
    return named


def _read_overrides(path: Path) -> dict[str, dict[str, Any]]:
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ArgumentError(f"cannot read {path}: {error.strerror or error}") from error
    except ValueError as error:
        raise ArgumentError(f"{path} is no JSON: {error}") from error
    if not isinstance(told, dict) or not all(isinstance(own, dict) for own in told.values()):
        raise ArgumentError(f"{path} holds no JSON object of subject -> inputs")
    return told


def _require_room(wanted: dict[str, Path | None]) -> None:
    for path in wanted.values():
        if path is not None and not path.absolute().parent.is_dir():
            raise ArgumentError(f"cannot write {path}: the folder {path.absolute().parent} does not exist")
