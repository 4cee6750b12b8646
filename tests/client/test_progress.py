import io
import re

from integument.cli.progress import Bar, Lines, Silent, choose_view
from integument.event import JobEvent
from rich.console import Console

ESCAPES = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")


def progress(percent: float, phase: str, message: str = "") -> JobEvent:
    return JobEvent("1", "progress", {"progress": percent, "phase": phase, "message": message})


def test_the_bar_moves_and_a_long_message_does_not_push_it_away() -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=100)
    with choose_view(console) as view:
        assert isinstance(view, Bar)
        on_bytes = view.transfer("upload [skin]")
        on_bytes(5_000_000, 10_000_000)
        view.on_event(progress(30, "shells: fat", "[bold]" + "x" * 300))
        view.on_event(JobEvent("2", "log", {"message": "a line [of] the log"}))
    drawn = ESCAPES.sub("", console.file.getvalue())  # type: ignore[attr-defined]
    last = drawn.splitlines()[-1]
    assert re.match(r"shells: fat +━+╸?╺?━+ +30 % 0:00:0\d \[bold\]x+…$", last), last
    assert "upload [skin]" in drawn
    assert "50 %" in drawn
    assert "a line [of] the log" in drawn


def test_elsewhere_a_line_per_phase_and_five_percent() -> None:
    console = Console(file=io.StringIO(), width=20)
    with choose_view(console) as view:
        assert isinstance(view, Lines)
        on_bytes = view.transfer("upload")
        on_bytes(1, 2_000_000)
        on_bytes(2_000_000, 2_000_000)
        for percent in range(20):
            view.on_event(progress(percent, "fat" if percent < 12 else "average_body"))
    printed = console.file.getvalue()  # type: ignore[attr-defined]
    lines = [re.sub(r"^ +[\d.]+ s +", "", line) for line in printed.splitlines()]
    assert lines == ["upload (2.0 MB)", "0 % fat", "5 % fat", "10 % fat", "12 % average_body", "17 % average_body"]


def test_quiet_shows_nothing() -> None:
    console = Console(file=io.StringIO())
    with choose_view(console, quiet=True) as view:
        assert isinstance(view, Silent)
        view.transfer("upload")(1, 1)
        view.on_event(progress(1, "fat"))
    assert console.file.getvalue() == ""  # type: ignore[attr-defined]
