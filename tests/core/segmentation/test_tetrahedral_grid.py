"""Whatever the voxels, the surface between them is a closed manifold that looks outward."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import label

from core.mesh import Mesh
from core.segmentation.tetrahedral_grid import NEIGHBOURS, surface_between
from core.validation.validate import validate


def halfway(inside: np.ndarray) -> Mesh:
    ends, faces = surface_between(inside)
    return Mesh.of(np.stack(np.unravel_index(ends, inside.shape), axis=-1).mean(axis=1), faces)


def test_one_voxel_has_a_vertex_on_each_of_its_edges() -> None:
    inside = np.zeros((3, 3, 3), dtype=bool)
    inside[1, 1, 1] = True
    mesh = halfway(inside)
    assert (len(mesh.vertices), len(mesh.faces)) == (14, 24)  # 14 edges, 24 tetrahedra around a node
    report = validate({"voxel": mesh})
    assert report.verdict == "simulation_ready"
    assert report.meshes["voxel"].volume_mm3 == pytest.approx(24 / 6 / 8)  # half of each of 24 tetrahedra, by side: an eighth


@pytest.mark.parametrize("seed", range(4))
def test_even_noise_has_a_sound_surface_with_the_pieces_of_the_grid(seed: int) -> None:
    inside = np.zeros((9, 9, 9), dtype=bool)
    inside[1:-1, 1:-1, 1:-1] = np.random.default_rng(seed).random((7, 7, 7)) < 0.5
    mesh = halfway(inside)
    found = validate({"noise": mesh})
    assert found.verdict == "simulation_ready"
    pieces = label(inside, structure=NEIGHBOURS)[1] + label(~inside, structure=NEIGHBOURS)[1] - 1
    assert found.meshes["noise"].components == pieces


def test_voxels_that_share_an_edge_or_a_corner_are_no_fault() -> None:
    for second in ((2, 2, 1), (2, 0, 1), (2, 2, 2), (2, 0, 2), (0, 2, 2)):
        inside = np.zeros((5, 5, 5), dtype=bool)
        inside[2, 2, 2] = inside[tuple(np.array(second) + 1)] = True
        assert validate({"pair": halfway(inside)}).verdict == "simulation_ready"
