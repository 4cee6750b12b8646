"""The end of a job for people: verdict, a row per mesh, findings."""

from __future__ import annotations

from rich import box
from rich.table import Table
from rich.text import Text

from integument.report import Finding, Report

SHOWN_FINDINGS = 20
STYLES = {"error": "red", "warning": "yellow", "info": "dim"}


def verdict_line(report: Report, seconds: float | None = None) -> Text:
    """`simulation_ready` in green or `not_ready` in red, with the summary and how long it took."""
    style = "bold green" if report.verdict == "simulation_ready" else "bold red"
    took = f" ({seconds:.1f} s)" if seconds is not None else ""
    return Text.assemble((report.verdict, style), f"{took}  {report.summary}")


def mesh_table(report: Report) -> Table:
    """A row per mesh, from outside inwards where depths are known. Intersections count those with itself and with others."""
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("mesh")
    for title in ("faces", "depth mm", "on target", "limited", "min gap mm", "intersections", "min q"):
        table.add_column(title, justify="right")
    depths = {name: numbers.target_mm for name, numbers in report.thickness.items()}
    for name in sorted(report.meshes, key=lambda mesh: depths.get(mesh, 0.0)):
        numbers, thickness = report.meshes[name], report.thickness.get(name)
        intersections = report.intersections(name)
        table.add_row(
            name,
            f"{numbers.faces:,}",
            _number(None if thickness is None else thickness.target_mm, ".2f"),
            _number(None if thickness is None else thickness.on_target_area, ".1%"),
            _number(None if thickness is None else thickness.limited_area, ".1%"),
            _number(report.smallest_gap_mm(name), ".3f"),
            Text(str(intersections), style="red" if intersections else "green"),
            _number(None if numbers.quality is None else numbers.quality.minimum, ".3f"),
        )
    return table


def comparison_table(report: Report) -> Table:
    """A row per surface that was made from another one: what became of it."""
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("before and after")
    for title in ("faces", "deviation mm", "rms mm", "volume", "min q"):
        table.add_column(title, justify="right")
    for name, numbers in report.comparisons.items():
        before, after = numbers.before, report.meshes[name]
        qualities = [None if mesh.quality is None else mesh.quality.minimum for mesh in (before, after)]
        table.add_row(
            name,
            f"{before.faces:,} → {after.faces:,}",
            _number(numbers.deviation.maximum_mm, ".3g"),
            _number(numbers.deviation.rms_mm, ".2g"),
            _number(numbers.volume_change, "+.3%"),
            f"{_number(qualities[0], '.3f')} → {_number(qualities[1], '.3f')}",
        )
    return table


def finding_lines(findings: tuple[Finding, ...]) -> list[Text]:
    """The worst first, at most twenty."""
    order = {"error": 0, "warning": 1, "info": 2}
    ranked = sorted(findings, key=lambda finding: order[finding.severity])
    lines = [
        Text.assemble((f"{finding.severity:<8}", STYLES[finding.severity]), f"{finding.code}: {finding.message}")
        for finding in ranked[:SHOWN_FINDINGS]
    ]
    if len(ranked) > SHOWN_FINDINGS:
        lines.append(Text(f"... and {len(ranked) - SHOWN_FINDINGS} more in the report", style="dim"))
    return lines


def _number(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)
