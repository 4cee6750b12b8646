"""The report of a process that could not do what it promises."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from core.errors import IntegumentError
from core.io.naming import make_unique
from core.io.registry import read_meshes
from core.mesh import Mesh
from core.processes.given_volume import given_volume
from core.processes.loaded_surfaces import load_surfaces
from core.processes.named_input import load_input
from core.processes.outcome import Outcome
from core.processes.software import software_versions
from core.processes.validate import METHODS as VALIDATE_METHODS
from core.processes.validate import REFERENCES
from core.reports.figures.compose import draw_mesh_figures
from core.run import SILENT
from core.schema.finding import Finding, Severity
from core.schema.processes import PROCESSES
from core.schema.report import FailureReport, Report
from core.schema.surfaces import SurfaceSubject
from core.validation.validate import validate

MOST_FACES_CHECKED = 2_000_000  # a failure should not keep people waiting
METHODS = "Nothing was made. The surfaces that were given were looked at nevertheless. "


def failure_outcome(process: str, payload: Mapping[str, Any], error: IntegumentError) -> Outcome:
    """Why and where it failed, with the meshes it was given, in pictures and in 3D, and the places if findings name any."""
    known = error.report or Report(process=process, verdict="not_ready", summary=error.message)
    findings = (*known.findings, *error.findings) or (
        Finding(code=error.code, severity=Severity.ERROR, message=error.message, count=1),
    )
    surfaces = _given(process, payload, error)
    looked_at = known if error.fault == "limit" else _looked_at(known, surfaces)
    report = looked_at.model_copy(
        update={
            "verdict": "not_ready",
            "failure": FailureReport(code=error.code, fault=error.fault),
            "summary": error.message,
            "findings": (*findings, *_others(looked_at.findings, findings)),
            **_methods(looked_at),
            "parameters": known.parameters
            or {**_asked(payload["inputs"]), "sha256": _sources(payload), **_volume(payload, error)},
            "software": software_versions(),
        }
    )
    figures = draw_mesh_figures(surfaces, pairs=report.pairs, findings=report.findings) if surfaces else ()
    return Outcome(report, (*error.figures, *figures), surfaces=surfaces)


def _looked_at(known: Report, surfaces: Mapping[str, Mesh]) -> Report:
    """What is known, and where not all surfaces were checked yet, what `validate` finds on them."""
    if set(surfaces) <= set(known.meshes) or not 0 < sum(len(mesh.faces) for mesh in surfaces.values()) <= MOST_FACES_CHECKED:
        return known
    found = validate(surfaces)
    measured = {"meshes": found.meshes, "pairs": found.pairs, "nesting": found.nesting}
    return known.model_copy(update={**measured, "findings": found.findings})


def _methods(report: Report) -> dict[str, Any]:
    """What may be cited of a failed job: its finished steps, else how its surfaces were looked at; never what it was to make."""
    if report.steps:
        return {}
    if not report.meshes:
        return {"methods": "", "references": ()}
    return {"methods": METHODS + VALIDATE_METHODS, "references": REFERENCES}


def _others(found: tuple[Finding, ...], told: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Those of a code that was not told yet: what stopped the job was found by the same checks."""
    codes = {finding.code for finding in told}
    return tuple(finding for finding in found if finding.code not in codes)


def _sources(payload: Mapping[str, Any]) -> dict[str, str]:
    """Name -> checksum of every upload the job was given; links tell nothing to somebody without the server."""
    names = make_unique(str(entry.get("name", "mesh")) for entry in payload["meshes"].values())
    return {
        name: str(entry["sha256"]) for name, entry in zip(names, payload["meshes"].values(), strict=True) if "sha256" in entry
    }


def _volume(payload: Mapping[str, Any], error: IntegumentError) -> dict[str, Any]:
    """What the label volume holds that the job was given, if it was one and no limit was reached."""
    asked = payload["inputs"].get("volume")
    held = {} if asked is None or error.fault == "limit" else given_volume(asked["href"], payload["meshes"])
    return {"volume": held} if held else {}


def _asked(inputs: Any) -> Any:
    """The inputs without their links."""
    if isinstance(inputs, Mapping):
        return {key: value for key, each in inputs.items() if key != "href" and (value := _asked(each)) != {}}
    return [_asked(each) for each in inputs] if isinstance(inputs, list | tuple) else inputs


def _given(process: str, payload: Mapping[str, Any], error: IntegumentError) -> dict[str, Mesh]:
    """The surfaces by name, as finished steps left them or else as they came; none where a limit was reached or where reading
    them is what failed."""
    left = {
        file["name"]: read_meshes(Path(file["path"]), file_name=file["file_name"], unit="mm").meshes[0].mesh
        for file in error.outputs
        if file["media_type"] == "model/stl"
    }
    if left:
        return left
    if error.fault == "limit" or not payload["meshes"]:
        return {}
    kind = PROCESSES[process].inputs
    try:
        if issubclass(kind, SurfaceSubject):
            return dict(load_surfaces(kind.model_validate(payload["inputs"]), payload["meshes"], SILENT).meshes)
        loaded = [load_input(href, payload["meshes"]) for href in payload["meshes"]]
    except (IntegumentError, ValidationError):
        return {}
    names = ["skin"] if len(loaded) == 1 else make_unique(entry.name for entry in loaded)
    return {name: entry.mesh for name, entry in zip(names, loaded, strict=True) if len(entry.mesh.faces)}
