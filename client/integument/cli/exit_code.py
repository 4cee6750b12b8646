"""What the shell learns."""

from __future__ import annotations

from enum import IntEnum

from integument.errors import (
    TRANSIENT_STATUSES,
    ArgumentError,
    IntegumentError,
    ProblemError,
    ReplyError,
    ServerNotInstalledError,
    ServerStartError,
    ServerUnreachableError,
)


class ExitCode(IntEnum):
    """The numbers are part of the contract."""

    READY = 0
    NOT_READY = 1
    """Done but not ready, or the process, the transfer or the server failed."""
    BAD_INPUT = 2
    """Bad usage, or the server refused the request."""
    UNREACHABLE = 3
    """No server, or one that cannot take work now."""
    INTERRUPTED = 130
    """Ctrl-C."""


def exit_code_of(error: IntegumentError) -> ExitCode:
    """The code of an error that ended a command."""
    if isinstance(error, ArgumentError | ServerNotInstalledError):
        return ExitCode.BAD_INPUT
    if isinstance(error, ServerUnreachableError | ServerStartError | ReplyError):
        return ExitCode.UNREACHABLE
    if isinstance(error, ProblemError):
        if error.status in TRANSIENT_STATUSES:
            return ExitCode.UNREACHABLE
        return ExitCode.BAD_INPUT if error.status < 500 else ExitCode.NOT_READY
    return ExitCode.NOT_READY
