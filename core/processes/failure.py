"""The report of a process that could not do what it promises."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from core.errors import IntegumentError
from core.io.naming import make_unique
from core.mesh import Mesh
from core.processes.loaded_surfaces import load_surfaces
from core.processes.named_input import load_input
from core.processes.outcome import Outcome
from core.processes.software import software_versions
from core.reports.figures.compose import draw_mesh_figures
from core.run import SILENT
from core.schema.finding import Finding, Severity
from core.schema.processes import PROCESSES
from core.schema.report import Report
from core.schema.surfaces import SurfacesInputs


def failure_outcome(process: str, payload: Mapping[str, Any], error: IntegumentError) -> Outcome:
    """Why and where it failed, with the meshes it was given, in pictures and in 3D, and the places if findings name any."""
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
    surfaces = _given(process, payload, error)
    figures = draw_mesh_figures(surfaces, pairs=report.pairs, findings=findings) if surfaces else ()
    return Outcome(report, (*error.figures, *figures), surfaces=surfaces)


def _given(process: str, payload: Mapping[str, Any], error: IntegumentError) -> dict[str, Mesh]:
    """The meshes of the job by name; none where a limit was reached or where reading them is what failed."""
    if error.fault == "limit" or not payload["meshes"]:
        return {}
    kind = PROCESSES[process].inputs
    try:
        if issubclass(kind, SurfacesInputs):
            return dict(load_surfaces(kind.model_validate(payload["inputs"]), payload["meshes"], SILENT).meshes)
        loaded = [load_input(href, payload["meshes"]) for href in payload["meshes"]]
    except (IntegumentError, ValidationError):
        return {}
    names = ["skin"] if len(loaded) == 1 else make_unique(entry.name for entry in loaded)
    return {name: entry.mesh for name, entry in zip(names, loaded, strict=True) if len(entry.mesh.faces)}
