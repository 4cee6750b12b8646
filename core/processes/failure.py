"""The report of a process that could not do what it promises."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.errors import IntegumentError
from core.processes.named_input import load_input
from core.processes.software import software_versions
from core.reports.figures.compose import draw_mesh_figures
from core.reports.figures.figure import Figure
from core.schema.finding import Finding, Severity
from core.schema.report import Report


def failure_report(process: str, payload: Mapping[str, Any], error: IntegumentError) -> tuple[Report, tuple[Figure, ...]]:
    """Why and where it failed, with pictures of the mesh and the places if findings name any."""
    known = error.report or Report(process=process, verdict="not_ready", summary=error.message)
    findings = (*known.findings, *error.findings) or (
        Finding(code=error.code, severity=Severity.ERROR, message=error.message, count=1),
    )
    report = known.model_copy(
        update={
            "verdict": "not_ready",
            "summary": error.message,
            "findings": findings,
            "parameters": known.parameters or {"inputs": payload["inputs"]},
            "software": software_versions(),
        }
    )
    return report, _pictures(payload, findings)


def _pictures(payload: Mapping[str, Any], findings: tuple[Finding, ...]) -> tuple[Figure, ...]:
    """The first mesh of the job with the places circled; none if no finding has a place."""
    if not any(finding.places for finding in findings) or not payload["meshes"]:
        return ()
    href = next(iter(payload["meshes"]))
    mesh = load_input(href, payload["meshes"]).mesh
    return draw_mesh_figures({"skin": mesh}, findings=findings)
