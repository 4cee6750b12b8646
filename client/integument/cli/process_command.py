"""Commands that run one process: each can name and label the job it asks for."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from typing import Annotated, Any

import typer

from integument.cli.options import LabelOption
from integument.cli.session import JobWords


def add_process_command(app: typer.Typer, run: Callable[..., None], name_option: str = "--name") -> None:
    """Register `run` as a command with `name_option` and --label, which reach it by the options of the call."""

    @wraps(run)
    def command(ctx: typer.Context, *, job_name: str | None, job_label: list[str] | None, **given: Any) -> None:
        ctx.obj = replace(ctx.obj, words=JobWords(job_name, tuple(job_label or ())))
        run(ctx, **given)

    name = Annotated[str | None, typer.Option(name_option, metavar="TEXT", help="What people call the job.")]
    # typer reads the parameters off the signature
    added = {"job_name": name, "job_label": LabelOption}
    known = inspect.signature(run, eval_str=True)
    more = [inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind) for key, kind in added.items()]
    parameters = [*known.parameters.values(), *more]
    command.__signature__ = known.replace(parameters=parameters)  # type: ignore[attr-defined]
    command.__annotations__ = {each.name: each.annotation for each in parameters}
    app.command()(command)
