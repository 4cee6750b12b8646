"""A real head as labels of voxels, segmented back: how far from the surfaces it was made of."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.schema.segment import SegmentParameters
from core.segmentation.segment import segment
from core.validation.validate import validate
from subjects.labelled_head import LABELS, head_surfaces, labelled

SIDE_MM = 5.0
GAP_MM = 0.1


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_tissues_of_a_head_come_back_within_a_voxel() -> None:
    surfaces = head_surfaces()
    volume = labelled(surfaces, (SIDE_MM,) * 3)
    names = {str(label): name for name, label in LABELS.items()}
    found = segment(volume, SegmentParameters(names=names), GAP_MM)
    proof = validate({name: each.mesh for name, each in found.items()}, min_gap_mm=GAP_MM)
    assert proof.verdict == "simulation_ready", proof.findings
    assert all(pair.intersecting_pairs == 0 for pair in proof.pairs)
    (head,) = surfaces["head"]
    distance = closest_points_in(FaceTree.of(head.vertices, head.faces), found["head"].mesh.vertices)[0]
    assert distance.mean() < 0.12 * SIDE_MM
    assert np.percentile(distance, 99) < 0.6 * SIDE_MM
    assert all(mesh.components == 1 for mesh in proof.meshes.values())
    # a cortex thinner than a voxel is not known so well
    for name, share in {"head": 0.01, "csf": 0.1, "white_matter": 0.1}.items():
        assert proof.meshes[name].volume_mm3 == pytest.approx(found[name].voxels_mm3, rel=share)
