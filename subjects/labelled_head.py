"""A head as labels of voxels: real surfaces, nested, filled into a grid. What a scan's segmentation looks like."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.geometry.containment import is_inside
from core.geometry.face_tree import FaceTree
from core.label_volume import LabelVolume
from core.mesh import Mesh
from subjects.fsaverage import brain, fsaverage

LABELS = {"head": 1, "csf": 2, "grey_matter": 3, "white_matter": 4}
MARGIN_VOXELS = 3


def head_surfaces() -> dict[str, tuple[Mesh, ...]]:
    """Tissue -> its surfaces in mm, each tissue within the one before: FreeSurfer's average head, inner skull, pial and white."""
    return {
        "head": (fsaverage("head"),),
        "csf": (fsaverage("inner_skull-bem"),),
        "grey_matter": (brain("pial", "left"), brain("pial", "right")),
        "white_matter": (brain("white", "left"), brain("white", "right")),
    }


def labelled(surfaces: Mapping[str, tuple[Mesh, ...]], sides_mm: tuple[float, float, float]) -> LabelVolume:
    """A voxel has the label of the last tissue that its centre is in; only where it is in all tissues before."""
    first = next(iter(surfaces.values()))
    low = np.min([mesh.vertices.min(axis=0) for mesh in first], axis=0)
    high = np.max([mesh.vertices.max(axis=0) for mesh in first], axis=0)
    sides = np.array(sides_mm)
    shape = tuple(int(count) for count in np.ceil((high - low) / sides) + 2 * MARGIN_VOXELS)
    affine = np.diag([*sides, 1.0])
    affine[:3, 3] = low - MARGIN_VOXELS * sides
    labels = np.zeros(shape, dtype=np.uint16)
    within = np.ones(shape, dtype=np.bool_)
    for name, meshes in surfaces.items():
        within &= np.logical_or.reduce([_filled(mesh, shape, affine) for mesh in meshes])
        labels[within] = LABELS[name]
    return LabelVolume.of(labels, affine)


def _filled(mesh: Mesh, shape: tuple[int, ...], affine: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Voxels (I, J, K) whose centres are inside; only those in the box around the mesh are asked."""
    inside = np.zeros(shape, dtype=np.bool_)
    sides, start = np.diag(affine)[:3], affine[:3, 3]
    first = np.maximum(np.floor((mesh.vertices.min(axis=0) - start) / sides).astype(int), 0)
    last = np.minimum(np.ceil((mesh.vertices.max(axis=0) - start) / sides).astype(int) + 1, shape)
    box = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
    voxels = np.moveaxis(np.indices(tuple(last - first)), 0, -1).reshape(-1, 3) + first
    found = is_inside(FaceTree.of(mesh.vertices, mesh.faces), voxels * sides + start)
    inside[box] = found.reshape(tuple(last - first))
    return inside
