"""A process asked for on the command line: what lies on this disk is sent, then the job is run to its end."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

import typer

from integument.cli.app import options_of
from integument.cli.job_run import Wanted, run_to_end
from integument.cli.mesh_reference import refer_to
from integument.cli.progress import ProgressView
from integument.cli.session import Session, connect
from integument.cli.surfaces_argument import Surfaces, refer_to_surfaces
from integument.surface_processes import Unit


@dataclass(frozen=True, slots=True)
class Sending:
    """Makes inputs of what was typed; files are uploaded, with progress."""

    session: Session
    view: ProgressView

    def mesh(self, text: str, unit: Unit) -> dict[str, str]:
        """The input that refers to one file or link."""
        return refer_to(self.session, self.view, text, unit)

    def surfaces(self, surfaces: Surfaces, unit: Unit) -> dict[str, Any]:
        """The inputs that name surfaces or a package."""
        return refer_to_surfaces(self.session, self.view, surfaces, unit)


def run_process(
    ctx: typer.Context, process: str, inputs: Mapping[str, Any], wanted: Wanted, send: Callable[[Sending], Mapping[str, Any]]
) -> NoReturn:
    """`send` gives the inputs that refer to files. Raises: ArgumentError before anything is started; typer.Exit at the end."""
    options = options_of(ctx)
    wanted.require_room()
    with connect(options) as session:
        view = options.progress_view()
        with view:
            sent = send(Sending(session, view))
        raise typer.Exit(run_to_end(session, options, process, {**inputs, **sent}, wanted))


def given(**inputs: Any) -> dict[str, Any]:
    """What was typed; the server's defaults hold for the rest."""
    return {name: value for name, value in inputs.items() if value is not None}
