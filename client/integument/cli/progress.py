"""How a running job looks: a bar on a terminal, plain lines elsewhere, JSON lines with --json, nothing with --quiet."""

from __future__ import annotations

import json
import sys
import time
from types import TracebackType
from typing import Protocol, Self

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Column
from rich.text import Text

from integument.cli.verdict_table import STYLES
from integument.event import JobEvent
from integument.report import Finding
from integument.upload import OnBytes

LINE_EVERY_PERCENT = 5.0
MEGABYTE = 1e6
BAR_WIDTH = 70  # of everything but the message


class ProgressView(Protocol):
    """A context that is told what happens."""

    def __enter__(self) -> Self: ...

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None: ...

    def on_event(self, event: JobEvent) -> None:
        """Something happened to the job."""

    def on_finding(self, finding: Finding) -> None:
        """The server noticed something about an upload."""

    def transfer(self, label: str) -> OnBytes:
        """A place for an upload or download to tell how far it is."""


class Silent:
    """--quiet."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        return None

    def on_event(self, event: JobEvent) -> None:
        """Nothing."""

    def on_finding(self, finding: Finding) -> None:
        """Nothing."""

    def transfer(self, label: str) -> OnBytes:
        """Nothing."""
        return lambda _done, _total: None


class JsonLines(Silent):
    """--json: one line per event on stderr; transfers are not told."""

    def on_event(self, event: JobEvent) -> None:
        """The event as the server sent it."""
        line = {"event": event.type, "id": event.id, **event.data}
        sys.stderr.write(json.dumps(line, ensure_ascii=False) + "\n")

    def on_finding(self, finding: Finding) -> None:
        """The finding as the server sent it."""
        sys.stderr.write(json.dumps({"event": "finding", **finding.as_json()}, ensure_ascii=False) + "\n")


class Lines(Silent):
    """No terminal: a line when a phase begins or five percent are done, and every line of the job's log."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._started = time.monotonic()
        self._phase = ""
        self._told = -LINE_EVERY_PERCENT

    def on_event(self, event: JobEvent) -> None:
        """Prints at most one line."""
        progress = event.progress
        if event.type == "log":
            self._print(f"       {event.message}")
        elif event.type == "progress" and progress is not None:
            if event.phase != self._phase or progress >= self._told + LINE_EVERY_PERCENT:
                self._phase, self._told = event.phase, progress
                self._print(f"{progress:4.0f} % {event.phase}  {event.message}".rstrip())
        elif event.type == "status":
            self._print(f"       {event.data.get('status', '')} {event.message}".rstrip())

    def on_finding(self, finding: Finding) -> None:
        """One line."""
        self._print(f"       {finding.severity} {finding.code}: {finding.message}")

    def transfer(self, label: str) -> OnBytes:
        """One line when it is done."""

        def on_bytes(done: int, total: int) -> None:
            if done == total:
                self._print(f"       {label} ({total / MEGABYTE:.1f} MB)")

        return on_bytes

    def _print(self, text: str) -> None:
        elapsed_s = time.monotonic() - self._started
        self._console.print(f"{elapsed_s:6.1f} s {text}", soft_wrap=True, highlight=False, markup=False)


class Bar:
    """A terminal: phase, bar, percent, message, elapsed."""

    def __init__(self, console: Console) -> None:
        self._progress = Progress(
            TextColumn("{task.description}", table_column=Column(width=22, no_wrap=True, overflow="ellipsis")),
            BarColumn(bar_width=30, table_column=Column(width=30)),
            TextColumn("{task.percentage:3.0f} %", table_column=Column(width=5, no_wrap=True)),
            TimeElapsedColumn(table_column=Column(width=7, no_wrap=True)),
            TextColumn("{task.fields[message]}", table_column=Column(no_wrap=True)),
            console=console,
        )
        self._job: TaskID | None = None

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._progress.stop()

    def on_event(self, event: JobEvent) -> None:
        """Moves the bar; log lines scroll above it."""
        if self._job is None:
            self._job = self._progress.add_task("waiting", total=100.0, message="")
        if event.type == "log":
            self._progress.console.print(Text(f"  {event.message}", "dim"))
            return
        if event.phase:
            self._progress.update(self._job, description=escape(event.phase))
        self._progress.update(self._job, completed=event.progress, message=escape(self._fitting(event.message)))

    def on_finding(self, finding: Finding) -> None:
        """Stays above the bars."""
        self._progress.console.print(Text(f"{finding.severity} {finding.code}: {finding.message}", STYLES[finding.severity]))

    def _fitting(self, message: str) -> str:
        """Rich would shrink the bar in favour of a long message."""
        room = max(10, self._progress.console.width - BAR_WIDTH)
        return message if len(message) <= room else message[: room - 1] + "…"

    def transfer(self, label: str) -> OnBytes:
        """A bar of its own."""
        task = self._progress.add_task(escape(label), total=None, message="")

        def on_bytes(done: int, total: int) -> None:
            self._progress.update(task, completed=done, total=total, message=f"{total / MEGABYTE:.1f} MB")

        return on_bytes


def choose_view(console: Console, *, as_json: bool = False, quiet: bool = False) -> ProgressView:
    """What fits the console and the options."""
    if quiet:
        return Silent()
    if as_json:
        return JsonLines()
    return Bar(console) if console.is_terminal else Lines(console)
