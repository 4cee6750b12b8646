"""The command that names and labels a job."""

from __future__ import annotations

import typer

from integument.cli.app import options_of
from integument.cli.job_table import job_lines
from integument.cli.jobs import JobArgument
from integument.cli.options import LabelOption, NameOption
from integument.cli.session import connect
from integument.errors import ArgumentError


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(label)


def label(ctx: typer.Context, job_id: JobArgument, name: NameOption = None, label: LabelOption = None) -> None:
    """Give a job another name or other labels; --name "" and --label "" take them away."""
    options = options_of(ctx)
    if name is None and label is None:
        raise ArgumentError("say what is to change: --name, --label, or both")
    labels = None if label is None else [one for one in label if one]
    with connect(options) as session:
        found = session.client.relabel(job_id, name=name, labels=labels)
    options.screen.document(found.as_json())
    for line in job_lines(found):
        options.screen.show(line)
