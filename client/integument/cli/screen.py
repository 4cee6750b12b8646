"""What goes where: results on stdout (one JSON document with --json), everything else on stderr."""

from __future__ import annotations

import json
import sys
from typing import Any

from rich.console import Console, RenderableType
from rich.text import Text

from integument.cli.exit_code import ExitCode
from integument.errors import IntegumentError, JobError, ProblemError

PIPE_WIDTH = 160  # a pipe has no width; tables must not be folded there


class Screen:
    """One per call."""

    def __init__(self, *, as_json: bool = False, quiet: bool = False) -> None:
        self.as_json = as_json
        self.quiet = quiet
        self.errors = _console(stderr=True)
        self._out = _console(stderr=False)

    def show(self, content: RenderableType) -> None:
        """A result for people; nothing with --json."""
        if not self.as_json:
            self._out.print(content, soft_wrap=isinstance(content, str | Text), highlight=False, markup=False)

    def document(self, content: object) -> None:
        """The result for programs; nothing without --json."""
        if self.as_json:
            sys.stdout.write(json.dumps(content, indent=2, ensure_ascii=False) + "\n")

    def note(self, text: str) -> None:
        """Good to know while it runs; not with --quiet or --json."""
        if not self.quiet and not self.as_json:
            self.errors.print(text, soft_wrap=True, highlight=False, markup=False)

    def failure(self, error: IntegumentError, code: ExitCode) -> None:
        """Why the command ends with this exit code; with --json it is the document."""
        if self.as_json:
            self.document({"error": describe_error(error), "exit_code": int(code)})
            return
        self.errors.print(f"error: {error}", style="red", soft_wrap=True, highlight=False, markup=False)
        if isinstance(error, ProblemError):
            for item in error.problem.errors:
                place = item.get("pointer") or item.get("loc") or ""
                detail = item.get("detail") or item.get("message") or ""
                self.errors.print(f"  {place}: {detail}", soft_wrap=True, highlight=False, markup=False)


def describe_error(error: IntegumentError) -> dict[str, Any]:
    """For programs: the class, a sentence, and the server's problem or the job's failure where there is one."""
    description: dict[str, Any] = {"type": type(error).__name__, "message": str(error)}
    if isinstance(error, ProblemError):
        description["problem"] = error.problem.as_json()
    if isinstance(error, JobError) and error.job.failure is not None:
        description["failure"] = error.job.failure.as_json()
    return description


def _console(*, stderr: bool) -> Console:
    console = Console(stderr=stderr)
    return console if console.is_terminal else Console(stderr=stderr, width=PIPE_WIDTH)
