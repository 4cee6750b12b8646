"""Winding numbers of cubes can be counted by hand."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.volume import signed_volumes
from core.healing.intersections.arrangement import Arrangement
from core.mesh import Mesh
from subjects.generated.pieces import inside_out, moved, together
from subjects.generated.solid import block


def test_overlapping_cubes_share_their_overlap() -> None:
    cubes = together(block(2, 2, 2), moved(block(2, 2, 2), 1, 1, 1))
    arrangement = Arrangement.of(cubes.vertices, cubes.faces)
    vertices, faces, birth = arrangement.union()
    assert signed_volumes(vertices, faces.astype(np.int32), np.zeros(len(faces), dtype=np.int64)) == pytest.approx([8 + 8 - 1])
    assert set(np.unique(arrangement.outside)) == {0, 1}
    assert set(birth) <= set(range(24))


@pytest.mark.parametrize(
    ("mesh", "outside"),
    [
        (block(2, 2, 2), {0}),
        (inside_out(block(2, 2, 2)), {-1}),
        (together(block(4, 4, 4), block(2, 2, 2)), {0, 1}),
        (together(block(4, 4, 4), inside_out(block(2, 2, 2))), {0}),
        (together(block(6, 6, 6), block(4, 4, 4), block(2, 2, 2)), {0, 1, 2}),
    ],
)
def test_winding_number_before_faces(mesh: Mesh, outside: set[int]) -> None:
    arrangement = Arrangement.of(mesh.vertices, mesh.faces)
    assert set(arrangement.outside.tolist()) == outside
    assert sorted(arrangement.birth) == list(range(len(mesh.faces)))  # nothing is cut
