"""Files of OpenMEEG: a `.tri` per surface, `.geom` with interfaces and domains, `.cond` with conductivities."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from core.package.tissue import FREE_SPACE, Tissue

FOLDER = "openmeeg"
STEM = "model"
AIR = "Air"


def write_model(folder: Path, tissues: Sequence[Tissue]) -> None:
    """Write `model.geom`, `model.cond` and one `.tri` per tissue into a folder that exists. Lengths are mm, as everywhere."""
    for tissue in tissues:
        (folder / f"{tissue.name}.tri").write_text(triangles_text(tissue.mesh), encoding="ascii", newline="\n")
    (folder / f"{STEM}.geom").write_text(geometry_text(tissues), encoding="ascii", newline="\n")
    (folder / f"{STEM}.cond").write_text(conductivities_text(tissues), encoding="ascii", newline="\n")


def triangles_text(mesh: Mesh) -> str:
    """A `.tri`: vertices with outward unit normals, then faces counted from 0. Nine digits bring every float32 back.

    Faces run clockwise seen from outside, against our habit: OpenMEEG turns every other surface round, with a notice."""
    normals = vertex_normals(mesh.vertices, mesh.faces)
    points = _rows("%.9g %.9g %.9g %.6f %.6f %.6f\n", np.hstack([mesh.vertices, normals]))
    return f"- {len(mesh.vertices)}\n{points}- {len(mesh.faces)} {len(mesh.faces)} {len(mesh.faces)}\n" + _rows(
        "%d %d %d\n", mesh.faces[:, ::-1]
    )


def geometry_text(tissues: Sequence[Tissue]) -> str:
    """A `.geom` 1.1: `-` a domain is inside an interface, `+` outside of it. Files are named relative to it."""
    interfaces = [f'Interface {tissue.name}: "{tissue.name}.tri"' for tissue in tissues]
    domains = [f"Domain {AIR}:{_outside_of(FREE_SPACE, tissues)}"] + [
        f"Domain {tissue.name}: -{tissue.name}{_outside_of(tissue.name, tissues)}" for tissue in tissues
    ]
    head = ["# Domain Description 1.1", "", f"Interfaces {len(tissues)}", "", *interfaces]
    return "\n".join([*head, "", f"Domains {len(domains)}", "", *domains]) + "\n"


def conductivities_text(tissues: Sequence[Tissue]) -> str:
    """A `.cond`: S/m per domain."""
    rows = [f"{AIR} 0.0", *(f"{tissue.name} {tissue.conductivity_s_per_m:.9g}" for tissue in tissues)]
    return "\n".join(["# Properties Description 1.0 (Conductivities)", "", *rows]) + "\n"


def _outside_of(name: str, tissues: Sequence[Tissue]) -> str:
    return "".join(f" +{tissue.name}" for tissue in tissues if tissue.enclosing == name)


def _rows(form: str, table: NDArray[Any]) -> str:
    """One format for all rows at once: a call per row takes ten times as long."""
    return (form * len(table)) % tuple(table.ravel().tolist())
