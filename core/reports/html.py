"""The report for people: one HTML file that needs nothing else. Its one script shows the surfaces and talks to nobody."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import Any

from markupsafe import Markup

from core.reports.change_entries import change_entries
from core.reports.figures.figure import Figure
from core.reports.prose import headline, verdict_words
from core.reports.scene.scene import Scene
from core.reports.scene.viewer import report_viewer
from core.reports.template import template
from core.reports.tissue_rows import nesting_lines, tissue_rows
from core.schema.finding import Finding, Severity
from core.schema.processes import PROCESSES
from core.schema.report import Report, StepReport

PNG_SIZE_AT = 16  # width and height as big-endian uint32 behind the signature and the chunk head


def render_html(report: Report, figures: Sequence[Figure], scene: Scene | None = None) -> str:
    """The whole page; names and messages are text, whatever they contain. Same report, figures and scene, same bytes.

    Raises: InternalError `report.viewer_missing`, `report.viewer_unfit` if there is a scene to show.
    """
    shown_by = [step.name for step in report.steps]
    embedded = _embed(figures, shown_by)
    steps = [
        _step_section(step, [embedded[figure.name] for figure in figures if figure.step == step.name]) for step in report.steps
    ]
    counts = {severity: sum(finding.severity is severity for finding in report.findings) for severity in Severity}
    ready = report.verdict == "simulation_ready"
    reason, lead = headline(report.summary) if report.failure else ("", report.summary)
    return template("report.html.j2").render(
        report=report,
        title=PROCESSES[report.process].title if report.process in PROCESSES else report.process,
        ready=ready,
        verdict=verdict_words(report.process, ready, report.failure),
        reason=reason,
        lead=lead,
        rows=tissue_rows(report),
        names={*report.meshes, *(place.mesh for finding in report.findings for place in finding.places)},
        nesting=nesting_lines(report),
        changes=change_entries(report.changes),
        findings=sorted(report.findings, key=_urgency),
        counts=counts,
        checksums=[(name, mesh.sha256) for name, mesh in report.meshes.items() if mesh.sha256],
        steps=steps,
        scene=None if scene is None else _shown(scene),
        figures=[embedded[figure.name] for figure in figures if figure.step not in shown_by],
    )


def _embed(figures: Sequence[Figure], steps: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Figure name -> what the page needs of it, numbered as the page shows them: those of no step first."""
    place = {"": 0, **{step: number for number, step in enumerate(steps, 1)}}
    ordered = sorted(figures, key=lambda figure: place.get(figure.step, 0))
    return {figure.name: _embedded(figure, number) for number, figure in enumerate(ordered, 1)}


def _step_section(step: StepReport, figures: Sequence[dict[str, Any]]) -> dict[str, Any]:
    return {
        "report": step,
        "rows": tissue_rows(step),
        "changes": change_entries(step.changes),
        "findings": sorted(step.findings, key=_urgency),
        "figures": figures,
    }


def _shown(scene: Scene) -> dict[str, Any]:
    """The scene with the viewer; scripts and licences are ours and go in as they are."""
    viewer = report_viewer()
    return {
        "about": scene.about,
        "data": base64.b64encode(scene.data).decode("ascii"),
        "error_mm": scene.error_mm,
        "faces": sum(surface["faces"] for surface in scene.about["surfaces"]),
        "thinned": [surface for surface in scene.about["surfaces"] if surface["name"] in scene.thinned],
        "policy": Markup(viewer.policy),  # noqa: S704
        "script": Markup(viewer.script),  # noqa: S704
        "licences": Markup(viewer.licences),  # noqa: S704
    }


def _urgency(finding: Finding) -> int:
    return list(Severity).index(finding.severity)


def _embedded(figure: Figure, number: int) -> dict[str, Any]:
    sizes = figure.png[PNG_SIZE_AT : PNG_SIZE_AT + 8]
    return {
        "name": figure.name,
        "number": number,
        "title": figure.title,
        "caption": figure.caption,
        "width": int.from_bytes(sizes[:4], "big"),
        "height": int.from_bytes(sizes[4:], "big"),
        "data": base64.b64encode(figure.png).decode("ascii"),
    }
