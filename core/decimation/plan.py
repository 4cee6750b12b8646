"""How many faces each surface and each region of it is to keep."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.decimation.fewest_faces import fewest_faces
from core.errors import InputError
from core.mesh import Mesh
from core.schema.decimate import DecimateInputs, DecimateRegion

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]
Flags = NDArray[np.bool_]

FEW = 2000  # faces; a goal above is left to the guards
PARITY = 2  # faces go in pairs, so the last pair may take one more than was to go


@dataclass(frozen=True, eq=False, slots=True)
class Plan:
    """For one surface. goal: faces to reach. label: (F,) region of each face, the last number outside all.

    room: (regions + 1,) faces that may go from each. fixed: (V,) vertices of regions that stay as they are.
    """

    goal: int
    label: Int32s
    room: Ints
    fixed: Flags


def make_plans(surfaces: Mapping[str, Mesh], inputs: DecimateInputs) -> dict[str, Plan]:
    """Share the target out.

    Raises: InputError `region.outside_mesh`, `region.overlap_conflict`, `decimate.targets_contradict`,
    `decimate.below_topology`.
    """
    labels = {name: _label(mesh, inputs.regions) for name, mesh in surfaces.items()}
    outside = sum(int((label == len(inputs.regions)).sum()) for label in labels.values())
    for region in inputs.regions:
        if not any(_is_in(mesh, region).any() for mesh in surfaces.values()):
            raise _outside(surfaces, region)
    ratios = np.array([region.ratio for region in inputs.regions])
    kept = {name: np.ceil(ratios * np.bincount(label, minlength=len(ratios) + 1)[:-1]) for name, label in labels.items()}
    if inputs.max_deviation_mm is not None:
        share = 0.0
    elif inputs.target_ratio is not None:
        share = inputs.target_ratio
    else:
        share = _share_of_rest(int(inputs.target_faces or 0), sum(float(row.sum()) for row in kept.values()), outside)
    return {name: _plan(name, mesh, labels[name], kept[name], share, inputs) for name, mesh in surfaces.items()}


def _share_of_rest(target: int, in_regions: float, rest: int) -> float:
    """What share of the faces outside the regions stays, if the target holds for all together."""
    if target < in_regions:
        raise InputError(
            "decimate.targets_contradict",
            f"target_faces {target:,} is less than the {int(in_regions):,} faces that the ratios of the regions keep",
            target_faces=target,
            region_faces=int(in_regions),
        )
    return min(1.0, (target - in_regions) / rest) if rest else 1.0


def _plan(name: str, mesh: Mesh, label: Int32s, kept: Floats, share: float, inputs: DecimateInputs) -> Plan:
    counts = np.bincount(label, minlength=len(kept) + 1)
    rest = math.floor(share * int(counts[-1]) + 1e-9)
    goal = int(kept.sum()) + rest
    # looked at only where it may matter: pieces and genus of a large surface take as long as thinning a part of it
    fewest = fewest_faces(mesh.faces) if goal < FEW else 0
    if inputs.max_deviation_mm is not None:
        goal = max(goal, fewest)
    if goal < fewest:
        raise InputError(
            "decimate.below_topology",
            f"{name} is to keep {goal:,} faces, but a closed surface of its topology has at least {fewest:,}",
            faces=goal,
            fewest_faces=fewest,
        )
    room = np.append(counts[:-1] - kept.astype(np.int64), counts[-1] - rest + PARITY)
    fixed = np.zeros(len(mesh.vertices), dtype=np.bool_)
    for row, region in enumerate(inputs.regions):
        if region.ratio == 1.0:
            fixed[mesh.faces[label == row].ravel()] = True
    return Plan(goal, label, room, fixed)


def _label(mesh: Mesh, regions: tuple[DecimateRegion, ...]) -> Int32s:
    label = np.full(len(mesh.faces), len(regions), dtype=np.int32)
    for row, region in enumerate(regions):
        inside = _is_in(mesh, region)
        taken = inside & (label < len(regions))
        for other in np.unique(label[taken]):
            if regions[other].ratio != region.ratio:
                both = int((label[taken] == other).sum())
                raise InputError(
                    "region.overlap_conflict",
                    f"regions '{regions[other].name}' (ratio {regions[other].ratio:g}) and '{region.name}' (ratio "
                    f"{region.ratio:g}) share {both:,} faces",
                    faces=both,
                )
        label[inside & ~taken] = row
    return label


def _is_in(mesh: Mesh, region: DecimateRegion) -> Flags:
    """Faces (F,) whose middle lies in the box."""
    middle = mesh.triangles().mean(axis=1)
    inside: Flags = ((middle >= region.box_mm.min) & (middle <= region.box_mm.max)).all(axis=1)
    return inside


def _outside(surfaces: Mapping[str, Mesh], region: DecimateRegion) -> InputError:
    low = np.min([mesh.vertices.min(axis=0) for mesh in surfaces.values()], axis=0)
    high = np.max([mesh.vertices.max(axis=0) for mesh in surfaces.values()], axis=0)
    reach = " to ".join("(" + ", ".join(f"{value:.6g}" for value in corner) + ")" for corner in (low, high))
    return InputError(
        "region.outside_mesh",
        f"no face lies in the box of region '{region.name}'; the surfaces reach from {reach} mm",
        region=region.name,
    )
