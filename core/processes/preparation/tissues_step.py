"""The step `tissues`: inner surfaces are sound and inside the skin, told before the costly steps begin."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from core.errors import InputError
from core.geometry.containment import is_inside
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from core.processes.named_input import NamedInput
from core.processes.preparation.skin_steps import SKIN
from core.processes.preparation.step_log import STEPS, StepLog
from core.run import RunContext
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.schema.prepare import PrepareInputs
from core.schema.report import StepReport
from core.validation.places import point_of
from core.validation.requirements import require_outward_surface

MOVABLE_SHARE = 0.25  # of the vertices of a tissue may lie outside the skin if it is to be moved; more is a wrong place or unit


def check_tissues(inputs: PrepareInputs, tissues: Mapping[str, NamedInput], skin: Mesh, log: StepLog) -> dict[str, Mesh]:
    """The surfaces by name, exact in float32.

    Raises: InputError `surface.*` about one of them, `tissues.outside_skin` with places.
    """
    if not tissues:
        log.leave_out("tissues", "there are none")
        return {}
    meshes = {name: tissue.mesh.rounded_to_float32() for name, tissue in tissues.items()}
    allowed = 0.0 if inputs.separate is None else MOVABLE_SHARE

    def work(run: RunContext) -> int:
        for number, (name, mesh) in enumerate(meshes.items()):
            require_outward_surface(mesh, name)
            run.advance((number + 1) / (len(meshes) + 1), f"{name}: {len(mesh.faces)} faces, closed")
        _require_inside(meshes, skin, allowed)
        return sum(len(mesh.faces) for mesh in meshes.values())

    faces = log.take("tissues", work, meshes, skin, allowed)
    log.tell(
        StepReport(
            name="tissues",
            title=STEPS["tissues"][0],
            summary=f"{len(meshes)} inner surfaces are closed, look outwards and belong inside the skin: {', '.join(meshes)}.",
            numbers={"surfaces": len(meshes), "faces of all": faces},
            changes=_shifts(tissues, meshes),
        ),
        {SKIN: skin, **meshes},
    )
    return meshes


def _require_inside(meshes: Mapping[str, Mesh], skin: Mesh, allowed: float) -> None:
    """allowed: share of a tissue's vertices that may lie outside."""
    tree = FaceTree.of(skin.vertices, skin.faces)
    findings = []
    for name, mesh in meshes.items():
        outside = np.flatnonzero(~is_inside(tree, mesh.vertices))
        share = len(outside) / len(mesh.vertices)
        if share > allowed:
            findings.append(
                Finding(
                    code="tissues.outside_skin",
                    severity=Severity.ERROR,
                    message=f"tissue '{name}' is not inside the skin: {len(outside)} of its {len(mesh.vertices)} vertices "
                    f"({share:.0%}) lie outside",
                    count=len(outside),
                    places=_spread_out(name, mesh, outside),
                )
            )
    if findings:
        words = "; ".join(finding.message for finding in findings)
        raise InputError("tissues.outside_skin", words, findings=tuple(findings), tissues=len(findings))


def _spread_out(name: str, mesh: Mesh, vertices: np.ndarray[Any, np.dtype[np.int64]]) -> tuple[Place, ...]:
    """Places at vertices (K,), evenly chosen if there are many."""
    chosen = vertices[np.unique(np.linspace(0, len(vertices) - 1, min(len(vertices), MAX_PLACES)).astype(np.int64))]
    return tuple(Place(mesh=name, point_mm=point_of(mesh.vertices[vertex]), vertices=(int(vertex),)) for vertex in chosen)


def _shifts(tissues: Mapping[str, NamedInput], meshes: Mapping[str, Mesh]) -> tuple[dict[str, Any], ...]:
    shifts = {name: float(np.abs(meshes[name].vertices - tissue.mesh.vertices).max()) for name, tissue in tissues.items()}
    return tuple(
        {"mesh": name, "what": "coordinates rounded to float32", "largest_shift_mm": shift}
        for name, shift in shifts.items()
        if shift
    )
