import inspect
import re

import integument
from integument import errors
from integument.cli.exit_code import ExitCode, exit_code_of
from integument.job import Job
from integument.problem import Problem


def classes() -> dict[str, type[Exception]]:
    members = inspect.getmembers(errors, inspect.isclass)
    return {name: member for name, member in members if issubclass(member, errors.IntegumentError)}


def test_the_tree_on_top_of_the_file_is_the_tree() -> None:
    assert errors.__doc__ is not None
    drawn: dict[str, str] = {}
    path: list[str] = []
    for line in errors.__doc__.splitlines():
        match = re.match(r"^([│ ├└─]*)(\w+Error)\b", line)
        if match:
            depth = len(match[1]) // 4
            path[depth:] = [match[2]]
            drawn[match[2]] = path[depth - 1] if depth else "Exception"
    assert drawn == {name: member.__bases__[0].__name__ for name, member in classes().items()}


def test_everything_public_is_exported() -> None:
    assert set(classes()) <= set(integument.__all__)
    assert all(hasattr(integument, name) for name in integument.__all__)
    assert integument.__all__ == sorted(integument.__all__)


def test_every_error_has_its_exit_code() -> None:
    def refused(status: int) -> errors.ProblemError:
        return errors.ProblemError(Problem(status=status, code="x.y"))

    failed = errors.JobFailedError(Job(id="j", status="failed"))
    assert exit_code_of(failed) is ExitCode.NOT_READY
    assert exit_code_of(errors.DownloadCorruptError("x", "a", "b")) is ExitCode.NOT_READY
    assert exit_code_of(errors.ArgumentError("x")) is ExitCode.BAD_INPUT
    assert exit_code_of(errors.ServerNotInstalledError()) is ExitCode.BAD_INPUT
    assert exit_code_of(errors.ServerStartError("x")) is ExitCode.UNREACHABLE
    assert exit_code_of(errors.ServerUnreachableError("u", "r", untouched=True)) is ExitCode.UNREACHABLE
    assert [exit_code_of(refused(status)) for status in (404, 413, 422)] == [ExitCode.BAD_INPUT] * 3
    assert [exit_code_of(refused(status)) for status in (429, 502, 503, 504)] == [ExitCode.UNREACHABLE] * 4
    assert exit_code_of(refused(500)) is ExitCode.NOT_READY
