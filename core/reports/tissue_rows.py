"""The table a professor reads first: one row per mesh with the numbers that decide."""

from __future__ import annotations

from dataclasses import dataclass

from core.reports.palette import as_hex, tissue_colours
from core.schema.report import MeshReport, Report, StepReport, ThicknessReport


@dataclass(frozen=True, slots=True)
class TissueRow:
    """`closest`: the mesh it comes nearest to, `gap_mm` away; both None without pairs."""

    name: str
    colour: str
    mesh: MeshReport
    thickness: ThicknessReport | None
    gap_mm: float | None
    closest: str | None
    intersections: int

    def self_and_others(self) -> int:
        """Intersecting pairs of faces within this mesh and with any other."""
        return self.mesh.self_intersecting_pairs + self.intersections


def tissue_rows(report: Report | StepReport) -> tuple[TissueRow, ...]:
    """In the order of the report, which is the order of nesting."""
    colours = tissue_colours(list(report.meshes))
    rows = []
    for name, mesh in report.meshes.items():
        own = [pair for pair in report.pairs if name in (pair.a, pair.b)]
        gaps = [(pair.min_gap_mm, pair.b if pair.a == name else pair.a) for pair in own if pair.min_gap_mm is not None]
        gap, closest = min(gaps, default=(None, None))
        crossing = sum(pair.intersecting_pairs for pair in own)
        rows.append(TissueRow(name, as_hex(colours[name]), mesh, report.thickness.get(name), gap, closest, crossing))
    return tuple(rows)


def nesting_lines(report: Report) -> tuple[tuple[int, str], ...]:
    """(depth, name) of every mesh, each below the one that encloses it."""
    lines: list[tuple[int, str]] = []

    def descend(parent: str | None, depth: int) -> None:
        for name, enclosing in report.nesting.items():
            if enclosing == parent and len(lines) <= len(report.nesting):
                lines.append((depth, name))
                descend(name, depth + 1)

    descend(None, 0)
    return tuple(lines)
