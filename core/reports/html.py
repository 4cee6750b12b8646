"""The report for people: one HTML file that needs nothing else, neither network nor script."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from core.reports import wording
from core.reports.change_entries import change_entries
from core.reports.figures.figure import Figure
from core.reports.tissue_rows import nesting_lines, tissue_rows
from core.schema.finding import Finding, Severity
from core.schema.processes import PROCESSES
from core.schema.report import Report

PNG_SIZE_AT = 16  # width and height as big-endian uint32 behind the signature and the chunk head


def render_html(report: Report, figures: Sequence[Figure]) -> str:
    """The whole page; names and messages are text, whatever they contain. Same report and figures, same bytes."""
    counts = {severity: sum(finding.severity is severity for finding in report.findings) for severity in Severity}
    return (
        _environment()
        .get_template("report.html.j2")
        .render(
            report=report,
            title=PROCESSES[report.process].title if report.process in PROCESSES else report.process,
            ready=report.verdict == "simulation_ready",
            rows=tissue_rows(report),
            nesting=nesting_lines(report),
            changes=change_entries(report.changes),
            findings=sorted(report.findings, key=_urgency),
            counts=counts,
            figures=[_embedded(figure) for figure in figures],
        )
    )


def _urgency(finding: Finding) -> int:
    return list(Severity).index(finding.severity)


def _embedded(figure: Figure) -> dict[str, Any]:
    sizes = figure.png[PNG_SIZE_AT : PNG_SIZE_AT + 8]
    return {
        "name": figure.name,
        "title": figure.title,
        "caption": figure.caption,
        "width": int.from_bytes(sizes[:4], "big"),
        "height": int.from_bytes(sizes[4:], "big"),
        "data": base64.b64encode(figure.png).decode("ascii"),
    }


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("core.reports", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    for word in (
        "whole",
        "significant",
        "area",
        "volume",
        "drift",
        "percent",
        "yes_no",
        "point",
        "numbers",
        "relation",
        "flattened",
    ):
        environment.filters[word] = getattr(wording, word)
    return environment
