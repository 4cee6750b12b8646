"""The surfaces a job is about: one, several by name, or those of a package; rounded to what their files will hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InternalError
from core.mesh import Mesh
from core.package.conductivity import conductivities
from core.package.manifest import TissueEntry
from core.package.read import read_package
from core.processes.named_input import load_input
from core.run import RunContext
from core.schema.conductivities import ConductivityInputs
from core.schema.surfaces import SurfaceSubject

ONE = "mesh"  # the name of a surface that came alone, and of its output


@dataclass(frozen=True, eq=False, slots=True)
class LoadedSurfaces:
    """What a job works on.

    meshes: by name, exact in float32; of a package in nesting order. tissues: by name what a package said of them, else empty.
    sources: what went in by name and checksum, as the parameters of a report hold it. changes: what rounding moved.
    conductivities_s_per_m: of every surface. together: they came as a set, so the result is a package, however many they are.
    """

    meshes: Mapping[str, Mesh]
    tissues: Mapping[str, TissueEntry]
    sources: Mapping[str, Any]
    changes: tuple[dict[str, Any], ...]
    conductivities_s_per_m: Mapping[str, float]
    together: bool


def load_surfaces(inputs: SurfaceSubject, entries: Mapping[str, Mapping[str, Any]], run: RunContext) -> LoadedSurfaces:
    """All surfaces of the inputs; the whole of `run`.

    Raises: InputError `reference.not_a_mesh`, `package.corrupt`, `package.checksum_mismatch`, `conductivity.unknown_tissue`;
    InternalError `reference.unresolved`, `canonical.corrupt`.
    """
    tissues: dict[str, TissueEntry] = {}
    if inputs.package is not None:
        href = inputs.package.href
        entry = entries.get(href)
        if entry is None:
            raise InternalError("reference.unresolved", f"{href} was accepted but not resolved", href=href)
        package = read_package(Path(entry["path"]))
        read: Mapping[str, Mesh] = package.surfaces
        sources: dict[str, Any] = {"package": {"name": entry["file_name"], "sha256": entry["sha256"]}}
        tissues = {tissue.name: tissue for tissue in package.manifest.tissues}
    else:
        references = {ONE: inputs.mesh} if inputs.mesh is not None else inputs.meshes or {}
        loaded = {name: load_input(reference.href, entries) for name, reference in references.items()}
        read = {name: source.mesh for name, source in loaded.items()}
        named = {name: {"name": source.name, "sha256": source.sha256} for name, source in loaded.items()}
        sources = named if inputs.mesh is not None else {"meshes": named}
    own: Mapping[str, float] = inputs.conductivities_s_per_m if isinstance(inputs, ConductivityInputs) else {}
    values = conductivities(read, own, {name: tissue.conductivity_s_per_m for name, tissue in tissues.items()})
    rounded = {name: mesh.rounded_to_float32() for name, mesh in read.items()}
    run.advance(1.0, ", ".join(f"{name}: {len(mesh.faces)} faces" for name, mesh in rounded.items()))
    return LoadedSurfaces(rounded, tissues, sources, _shifts(read, rounded), values, inputs.mesh is None)


def _shifts(read: Mapping[str, Mesh], rounded: Mapping[str, Mesh]) -> tuple[dict[str, Any], ...]:
    shifts = {name: float(np.abs(rounded[name].vertices - mesh.vertices).max()) for name, mesh in read.items()}
    return tuple(
        {"mesh": name, "what": "coordinates rounded to float32", "largest_shift_mm": shift}
        for name, shift in shifts.items()
        if shift
    )
