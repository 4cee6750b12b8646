"""Flips on four points whose angles are known."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.quality import quality
from core.mesh import Mesh
from core.smoothing.delaunay import find_flips


def kite(height: float, lift: float = 0.0) -> Mesh:
    """Two faces over the edge 0-1 of length 2, their tips `height` away from it on either side, one lifted out of the plane."""
    return Mesh.of([[-1, 0, 0], [1, 0, 0], [0, height, lift], [0, -height, 0]], [[0, 1, 2], [1, 0, 3]])


def flips(mesh: Mesh, movable=None):
    # ends need a third neighbour each, as in a larger surface, or they would be left with two
    vertices = np.vstack((mesh.vertices, [[-3, 0, 0], [3, 0, 0]]))
    faces = np.vstack((mesh.faces, [[0, 2, 4], [3, 0, 4], [1, 5, 2], [5, 1, 3]])).astype(np.int32)
    everything = np.ones(6, dtype=bool) if movable is None else np.asarray(movable)
    pairs, corners = find_flips(vertices, faces, everything)
    flipped = faces.copy()
    flipped[pairs.ravel()] = corners
    return vertices, faces, flipped, len(pairs)


def test_an_edge_opposite_wide_angles_flips():
    vertices, before, after, count = flips(kite(0.5))
    assert count == 1
    assert sorted(map(sorted, after[:2].tolist())) == [[0, 2, 3], [1, 2, 3]]
    assert (after[2:] == before[2:]).all()
    normals = np.cross(vertices[after[:, 1]] - vertices[after[:, 0]], vertices[after[:, 2]] - vertices[after[:, 0]])
    assert (normals[:2, 2] > 0).all()
    assert quality(vertices, after[:2]).min() > quality(vertices, before[:2]).min()


@pytest.mark.parametrize("height", [1.0, 1.2])
def test_an_edge_opposite_right_or_sharp_angles_stays(height):
    assert flips(kite(height))[3] == 0


def test_a_crease_stays_and_a_gentle_bend_does_not():
    # the bend is measured between all four faces, so a lift of the tip by a fifth is too much, a hundredth is not
    assert flips(kite(0.5, lift=0.1))[3] == 0
    assert flips(kite(0.5, lift=0.005))[3] == 1


@pytest.mark.parametrize("fixed", range(4))
def test_all_four_corners_must_be_movable(fixed):
    assert flips(kite(0.5), [corner != fixed for corner in range(6)])[3] == 0


def test_no_vertex_is_left_with_two_neighbours():
    mesh = kite(0.5)
    assert len(find_flips(mesh.vertices, mesh.faces, np.ones(4, dtype=bool))[0]) == 0


def test_an_edge_that_exists_already_is_not_made_again():
    # a third face joins the tips behind the two: the flipped edge would have three faces
    mesh = kite(0.5)
    vertices = np.vstack((mesh.vertices, [[-3, 0, 0], [3, 0, 0], [0, 0, 5]]))
    faces = np.vstack((mesh.faces, [[0, 2, 4], [3, 0, 4], [1, 5, 2], [5, 1, 3], [2, 3, 6]])).astype(np.int32)
    assert len(find_flips(vertices, faces, np.ones(7, dtype=bool))[0]) == 0
