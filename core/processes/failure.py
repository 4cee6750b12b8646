"""The report of a process that could not do what it promises."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.errors import IntegumentError
from core.processes.loaded_surfaces import load_surfaces
from core.processes.named_input import load_input
from core.processes.software import software_versions
from core.reports.figures.compose import draw_mesh_figures
from core.reports.figures.figure import Figure
from core.run import SILENT
from core.schema.finding import Finding, Severity
from core.schema.processes import PROCESSES
from core.schema.report import Report
from core.schema.surfaces import SurfacesInputs


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
    return report, (*error.figures, *_pictures(process, payload, findings))


def _pictures(process: str, payload: Mapping[str, Any], findings: tuple[Finding, ...]) -> tuple[Figure, ...]:
    """The meshes of the job with the places circled; none if no finding has a place."""
    if not any(finding.places for finding in findings) or not payload["meshes"]:
        return ()
    kind = PROCESSES[process].inputs
    if issubclass(kind, SurfacesInputs):
        meshes = load_surfaces(kind.model_validate(payload["inputs"]), payload["meshes"], SILENT).meshes
        return draw_mesh_figures(meshes, findings=findings)
    href = next(iter(payload["meshes"]))
    return draw_mesh_figures({"skin": load_input(href, payload["meshes"]).mesh}, findings=findings)
