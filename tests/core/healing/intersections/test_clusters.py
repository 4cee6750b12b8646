"""Intersections near each other belong together, others do not."""

from __future__ import annotations

import numpy as np

from core.geometry.exact_intersection import find_intersecting_faces
from core.healing.intersections.clusters import find_clusters
from core.mesh import Mesh
from subjects.damage.folds import folded, pierced
from subjects.generated.pieces import moved, together
from subjects.generated.revolved import ball


def clusters_of(mesh: Mesh) -> list[tuple[int, int]]:
    pairs = find_intersecting_faces(mesh.vertices, mesh.faces)
    found = find_clusters(mesh.faces, len(mesh.vertices), pairs)
    assert sorted(np.concatenate([cluster.faces for cluster in found])) == sorted(np.unique(pairs))
    return [(len(cluster.faces), cluster.patches) for cluster in found]


def test_folds_apart_are_clusters_of_one_patch() -> None:
    mesh = folded(ball(30, 4), np.random.default_rng(1), 3)
    assert [patches for _, patches in clusters_of(mesh)] == [1, 1, 1]


def test_spike_through_the_other_side_joins_two_patches() -> None:
    assert [patches for _, patches in clusters_of(pierced(ball(30, 4), np.array([0, 0, 30.0]), 70.0))] == [2]


def test_pieces_that_overlap_are_one_cluster_of_two_patches() -> None:
    assert [patches for _, patches in clusters_of(together(ball(30, 4), moved(ball(10, 3), 28, 1, 2)))] == [2]


def test_nothing_intersects() -> None:
    mesh = ball(30, 2)
    assert find_clusters(mesh.faces, len(mesh.vertices), np.empty((0, 2), dtype=np.int64)) == []
