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


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_tissues_of_a_head_become_shells_in_each_other() -> None:
    """Both hemispheres are one tissue in two pieces: `keep_largest` would drop one of them."""
    inside = {"white_matter": "grey_matter", "grey_matter": "csf", "csf": "head"}
    asked = SegmentParameters(names={str(label): name for name, label in LABELS.items()}, inside=inside, islands="keep_above")
    found = segment(labelled(head_surfaces(), (4.0,) * 3), asked, GAP_MM)
    proof = validate({name: each.mesh for name, each in found.items()}, min_gap_mm=GAP_MM)
    assert proof.verdict == "simulation_ready", proof.findings
    assert proof.nesting == {"head": None, **inside}
    assert sum(pair.intersecting_pairs for pair in proof.pairs) == 0
    for name, mesh in proof.meshes.items():
        assert mesh.volume_mm3 == pytest.approx(found[name].voxels_mm3, rel=0.02)
    assert found["white_matter"].dropped < 0.01 * found["white_matter"].labelled
