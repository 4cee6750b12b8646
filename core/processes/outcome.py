"""What a process hands back: a report, pictures for it, and files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from core.reports.figures.figure import Figure
from core.schema.report import Report


@dataclass(frozen=True, slots=True)
class OutputFile:
    """One file a client can fetch; `path` is relative to the folder the process was given."""

    name: str
    path: Path
    media_type: str
    file_name: str

    def listed(self, out_dir: Path) -> dict[str, str]:
        """As the worker is told of it; `out_dir` is the folder the process was given."""
        return {
            "name": self.name,
            "path": str(out_dir / self.path),
            "media_type": self.media_type,
            "file_name": self.file_name,
        }


@dataclass(frozen=True, slots=True)
class Outcome:
    """The end of a process that did what it promises; `report.verdict` may still be not_ready."""

    report: Report
    figures: tuple[Figure, ...]
    files: tuple[OutputFile, ...] = ()
