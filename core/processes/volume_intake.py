"""Intake of a label volume: read, told in numbers, written in canonical form. Runs in the limited child, called by `intake`."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.io.canonical_volume import save_volume
from core.io.extents import check_extents
from core.io.naming import clean_name, stem_of
from core.io.unit import Unit
from core.io.volume import EXTENSIONS, read_volume
from core.label_volume import LabelVolume

FACES_PER_SIDE = 6  # of the first surface, measured on spheres, for each side of a voxel between a label and nothing
SHARED = 1.5  # a side between two labels has one surface where one encloses the other, else two


def take_in_volume(path: Path, file_name: str, unit: Unit, out_dir: Path) -> dict[str, Any]:
    """As `intake.run` of a mesh, with "volume": {"voxels", "voxel_mm", "affine", "labels": [{"label", "voxels", "volume_mm3"}],
    "expected_faces"}; vertices and faces are 0. Raises: as `core.io.volume.read_volume`."""
    volume, findings, kind = read_volume(path, unit, file_name)
    name = clean_name(stem_of(Path(file_name).name, EXTENSIONS), "volume")
    target = out_dir / "0.mesh"
    save_volume(volume, target)
    extents = _extents_mm(volume)
    noticed = (*findings, *check_extents(extents, unit, name))
    mesh = {"name": name, "path": str(target), "vertices": 0, "faces": 0, "extents_mm": extents.tolist(), "arrays": []}
    return {
        "format": kind,
        "meshes": [mesh],
        "findings": [finding.model_dump(mode="json") for finding in noticed],
        "volume": {
            "voxels": list(volume.labels.shape),
            "voxel_mm": volume.voxel_mm().tolist(),
            "affine": volume.affine.tolist(),
            "labels": [
                {"label": label, "voxels": count, "volume_mm3": count * volume.voxel_mm3()}
                for label, count in volume.counts().items()
            ],
            "expected_faces": _expected_faces(volume),
        },
    }


def _extents_mm(volume: LabelVolume) -> NDArray[np.float64]:
    """Of the box around all labelled voxels, (3,), along x, y and z."""
    used = volume.labels > 0
    ranges = [np.flatnonzero(used.any(axis=others))[[0, -1]] for others in ((1, 2), (0, 2), (0, 1))]
    corners = np.array(list(product(*((low - 0.5, high + 0.5) for low, high in ranges))))
    extents: NDArray[np.float64] = np.ptp(volume.places_mm(corners), axis=0)
    return extents


def _expected_faces(volume: LabelVolume) -> int:
    labels = np.pad(volume.labels, 1)
    sides = 0.0
    for axis in range(3):
        first, second = (np.delete(labels, end, axis=axis) for end in (-1, 0))
        differ = first != second
        shared = int((differ & (first > 0) & (second > 0)).sum())
        sides += int(differ.sum()) + (SHARED - 1.0) * shared
    return int(FACES_PER_SIDE * sides)
