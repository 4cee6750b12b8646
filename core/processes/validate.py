"""The process `validate`: look at meshes, alone and against each other."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.io.naming import make_unique
from core.processes.named_input import NamedInput, load_input
from core.processes.outcome import Outcome
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.reports.figures.compose import draw_mesh_figures
from core.run import RunContext
from core.schema.reference import MeshReference
from core.schema.report import Report
from core.schema.validate import ValidateInputs
from core.validation.validate import Validation

METHODS = (
    "Surfaces were checked for closedness, edge- and vertex-manifoldness, orientation, degenerate and duplicate faces. "
    "Self-intersections and intersections between surfaces were found with exact predicates [1] and sorted into the three "
    "cases of [2]. The smallest gap of every pair is the minimum over all pairs of faces of their exact distance in double "
    "precision. Triangle quality is q = 2 r_in / r_out [2]."
)
REFERENCES = (
    "[1] A. Jacobson, D. Panozzo et al., libigl: A simple C++ geometry processing library, 2018; exact arithmetic by CGAL",
    "[2] S. N. Makarov, G. M. Noetscher, A. Nazarian, Low-Frequency Electromagnetic Modeling for Electrical and Biological "
    "Systems Using MATLAB, Wiley, 2015",
)


def run_validate(inputs: ValidateInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """Whatever the meshes are like, this succeeds; the verdict says what they are fit for."""
    del out_dir  # a report is all it leaves
    load = run.stage("load", 0.0, 0.1)
    loaded = _load(inputs, meshes)
    load.advance(1.0, f"{len(loaded)} meshes, {sum(len(entry.mesh.faces) for entry in loaded.values())} faces")
    surfaces = {name: entry.mesh for name, entry in loaded.items()}
    validation = validate_once(surfaces, inputs.min_gap_mm, run.stage("validate", 0.1, 0.6))
    run.stage("figures", 0.6, 1.0)
    figures = draw_mesh_figures(surfaces, pairs=validation.pairs, findings=validation.findings)
    report = Report(
        process="validate",
        verdict=validation.verdict,
        summary=_summary(validation),
        meshes=validation.meshes,
        pairs=validation.pairs,
        nesting=validation.nesting,
        findings=validation.findings,
        methods=METHODS,
        references=REFERENCES,
        parameters={
            "min_gap_mm": inputs.min_gap_mm,
            "inputs": {name: {"name": entry.name, "sha256": entry.sha256} for name, entry in loaded.items()},
        },
        software=software_versions(),
    )
    return Outcome(report, figures, surfaces=surfaces)


def _load(inputs: ValidateInputs, meshes: Mapping[str, Mapping[str, Any]]) -> dict[str, NamedInput]:
    """By the names asked for, else by the names of the uploads, made unique."""
    asked = inputs.meshes
    if isinstance(asked, dict):
        return {name: load_input(reference.href, meshes) for name, reference in asked.items()}
    references = [asked] if isinstance(asked, MeshReference) else asked
    loaded = [load_input(reference.href, meshes) for reference in references]
    return dict(zip(make_unique(entry.name for entry in loaded), loaded, strict=True))


def _summary(validation: Validation) -> str:
    errors = sum(finding.severity == "error" for finding in validation.findings)
    count = len(validation.meshes)
    subject = "1 mesh is" if count == 1 else f"{count} meshes are"
    if validation.verdict == "simulation_ready":
        return f"{subject} simulation ready: closed, manifold, outward, free of intersections{' and apart' if count > 1 else ''}."
    return f"{subject} not ready: {errors} finding{'s' if errors != 1 else ''} forbid{'s' if errors == 1 else ''} it."
