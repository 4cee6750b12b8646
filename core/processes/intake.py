"""Intake of an upload: the one place where bytes from outside are parsed. Runs in the limited child."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import face_areas
from core.io import canonical
from core.io.naming import clean_name
from core.io.reading import Intake, NamedMesh
from core.io.registry import read_meshes
from core.io.unit import require_unit
from core.io.volume import find_volume_format
from core.io.welding import weld
from core.mesh import Mesh
from core.processes.field_intake import is_coil, is_field, take_in_coil, take_in_field
from core.processes.volume_intake import take_in_volume
from core.schema.finding import Finding, Severity

MOST_NAMES_SHOWN = 20
OTHERS = ((find_volume_format, take_in_volume), (is_field, take_in_field), (is_coil, take_in_coil))
"""What else than a surface an upload may be: how it is known, and who takes it in."""


def run(payload: dict[str, Any], channel: object) -> dict[str, Any]:
    """Parse payload["path"] (called `file_name` by the user, in `unit`) and write it as `out_dir`/0.mesh in canonical form.

    Several solids become one mesh: they are welded where their corners are equal, as if the file had not named them.
    Arrays with a number per vertex are kept beside the mesh as they are. Returns {"format", "meshes": [{"name", "path",
    "vertices", "faces", "extents_mm", "area_mm2", "arrays": [{"name", "minimum", "maximum", "not_finite"}]}], "findings"},
    all plain JSON.
    A label volume, a field and a coil become no mesh: see `volume_intake` and `field_intake`.
    Raises: InputError and LimitError as `core.io.registry.read_meshes` and the intakes named; InputError `unit.unknown`.
    """
    del channel  # a parse takes seconds: there is no progress to tell
    unit = require_unit(payload["unit"])
    path, file_name, out_dir = Path(payload["path"]), payload["file_name"], Path(payload["out_dir"])
    for is_one, take_in in OTHERS:
        if is_one(path, file_name):
            return take_in(path, file_name, unit, out_dir)
    intake = read_meshes(path, file_name=file_name, unit=unit)
    combined = combine(intake.meshes, clean_name(Path(file_name).stem, "mesh"))
    findings = (*intake.findings, *check_solids(intake))
    target = out_dir / "0.mesh"
    canonical.save(combined.mesh, target, combined.arrays)
    return {
        "format": intake.format,
        "meshes": [_describe(combined, target)],
        "findings": [finding.model_dump(mode="json") for finding in findings],
    }


def combine(meshes: tuple[NamedMesh, ...], name: str) -> NamedMesh:
    """One mesh out of several, under `name`; a single one is handed through. Formats with several have no arrays."""
    if len(meshes) == 1:
        return meshes[0]
    starts = np.cumsum([0] + [len(each.mesh.vertices) for each in meshes[:-1]])
    vertices, index = weld(np.concatenate([each.mesh.vertices for each in meshes]))
    faces = np.concatenate([each.mesh.faces + start for each, start in zip(meshes, starts, strict=True)])
    return NamedMesh(name, Mesh.of(vertices, index[faces]))


def check_solids(intake: Intake) -> list[Finding]:
    """Tell which solids a file held when there are several (`mesh.several_solids`)."""
    count = len(intake.meshes)
    if count == 1:
        return []
    shown = [f"{each.name} ({len(each.mesh.faces)} faces)" for each in intake.meshes[:MOST_NAMES_SHOWN]]
    more = f" and {count - MOST_NAMES_SHOWN} more" if count > MOST_NAMES_SHOWN else ""
    message = f"the file holds {count} solids, taken as one mesh: {', '.join(shown)}{more}"
    return [Finding(code="mesh.several_solids", severity=Severity.WARNING, message=message, count=count)]


def _describe(named: NamedMesh, path: Path) -> dict[str, Any]:
    mesh = named.mesh
    return {
        "name": named.name,
        "path": str(path),
        "vertices": len(mesh.vertices),
        "faces": len(mesh.faces),
        "extents_mm": mesh.extents_mm().tolist(),
        "area_mm2": float(face_areas(mesh.vertices, mesh.faces).sum()),
        "arrays": [_describe_array(name, values) for name, values in sorted(named.arrays.items())],
    }


def _describe_array(name: str, values: NDArray[np.float64]) -> dict[str, Any]:
    """Extremes of the finite numbers, null if there are none."""
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (None, None)
    return {"name": name, "minimum": low, "maximum": high, "not_finite": len(values) - len(finite)}
