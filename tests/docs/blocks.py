"""The code blocks of the documentation, and what a comment above a block says about running it.

`<!-- run: slow -->` runs it with `pytest -m slow` on the whole body; `<!-- run: no, WHY -->` only reads it: commands must parse,
and what they name must exist. Without a comment a block runs in `make test`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from tests.project.sources import ROOT

RUNNABLE = {"console", "sh", "python", "matlab", "json"}
SHOWN = {"text", "ini"}  # what a file holds, not what anybody types
FENCE = re.compile(
    r"^(?:<!-- run: (?P<how>slow|no, [^>]+?) -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$", flags=re.MULTILINE | re.DOTALL
)
PAGES = sorted(
    path
    for path in [*ROOT.glob("*.md"), ROOT / "client" / "README.md", *(ROOT / "docs").rglob("*.md")]
    if not path.is_relative_to(ROOT / "docs" / "site")
)


@dataclass(frozen=True, slots=True)
class Block:
    """One block. how: `run`, `slow`, or `no, WHY`. line: of its first line of text."""

    page: str
    line: int
    language: str
    how: str
    text: str

    @property
    def is_read_only(self) -> bool:
        """Nobody runs it."""
        return self.how.startswith("no, ")

    @property
    def place(self) -> str:
        """As a reader looks for it."""
        return f"{self.page}:{self.line}"

    def commands(self) -> str:
        """The shell lines, without the prompts of a `console` block. Raises: ValueError if it shows output."""
        if self.language != "console":
            return self.text
        lines, goes_on = [], False
        for line in self.text.splitlines():
            if not goes_on and not line.startswith("$ "):
                raise ValueError(f"{self.place}: `{line}` is no command; output is not shown, since nobody would check it")
            lines.append(line if goes_on else line[2:])
            goes_on = line.endswith("\\")
        return "\n".join(lines) + "\n"


def blocks(path: Path) -> list[Block]:
    """Of one page, in order."""
    text = path.read_text(encoding="utf-8")
    page = str(path.relative_to(ROOT))
    return [
        Block(page, text.count("\n", 0, match.start("text")) + 1, match["language"], match["how"] or "run", match["text"])
        for match in FENCE.finditer(text)
    ]


ALL = [block for page in PAGES for block in blocks(page)]


def pages_with(*hows: str) -> list[str]:
    """Pages that have programs or commands to be run in one of these ways."""
    return sorted({block.page for block in ALL if block.how in hows and block.language in RUNNABLE - {"json"}})
