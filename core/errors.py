"""The tree of failures a user may read.

IntegumentError
├── InputError        the request or the mesh is at fault: change it, do not retry
├── LimitError        a limit of this server was reached: smaller input or another server
├── StateError        the thing asked for is not there, or not in a state that allows it
└── InternalError     our fault: a broken promise or a lost worker; a retry may help

`code` is stable and documented (docs/errors.md), `facts` are plain numbers and ids that the message names too.
HTTP statuses live in api/problems.py; nothing here knows about the web.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

if TYPE_CHECKING:
    from core.reports.figures.figure import Figure
    from core.schema.finding import Finding
    from core.schema.report import Report

Fault = Literal["input", "limit", "state", "internal"]
Fact = int | float | str | bool


class IntegumentError(Exception):
    """Root of all failures a user may read."""

    fault: ClassVar[Fault] = "internal"
    retryable: ClassVar[bool] = False

    def __init__(
        self,
        code: str,
        message: str,
        *,
        findings: tuple[Finding, ...] = (),
        report: Report | None = None,
        **facts: Fact,
    ) -> None:
        """`findings` name places on the mesh; `report` is what is known so far, so a failed job has one too."""
        super().__init__(message)
        self.code = code
        self.message = message
        self.findings = findings
        self.report = report
        self.figures: tuple[Figure, ...] = ()  # drawn before it failed, for that report
        self.facts: dict[str, Fact] = facts
        self.outputs: tuple[dict[str, Any], ...] = ()  # files a failed process still left, as in its result (report, report_html)

    def describe(self) -> dict[str, Any]:
        """The JSON form that crosses process borders; `revive` reads it back."""
        return {
            "code": self.code,
            "message": self.message,
            "fault": self.fault,
            "facts": self.facts,
            "findings": [finding.model_dump(mode="json") for finding in self.findings],
        }


class InputError(IntegumentError):
    """The request, the file or the geometry is at fault."""

    fault = "input"


class LimitError(IntegumentError):
    """A stated limit of this server was reached (size, memory, time)."""

    fault = "limit"


class StateError(IntegumentError):
    """The thing asked for does not exist, or its state forbids the act."""

    fault = "state"


class InternalError(IntegumentError):
    """A promise was broken or a worker was lost."""

    fault = "internal"
    retryable = True


CLASSES_BY_FAULT: dict[str, type[IntegumentError]] = {
    error.fault: error for error in (InputError, LimitError, StateError, InternalError)
}
