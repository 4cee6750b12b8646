"""How fine two surfaces would have to be where they cross because their faces are too large to follow each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.bisection import longest_edges
from core.geometry.components import label_connected
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from core.separation.contacts import find_contacts
from core.separation.relations import Relation
from core.separation.sides import are_vertices_inside

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class EdgeNeeded:
    """In mm: the longest edge that would do, the longest there is among the faces that are too close, and how deep they cross."""

    edge_mm: float
    longest_mm: float
    depth_mm: float


def find_edge_needed(a: Mesh, b: Mesh, relation: Relation, gap_mm: float) -> EdgeNeeded | None:
    """The edge a chord of the deepest crossing may have; None if all edges there are so short already, or no vertex crossed.

    What a chord cuts off grows with the square of its length: of a crossing w wide and d deep, edges of w √(gap / (d + gap)) cut
    off no more than the gap. relation: what a is to b, by the surfaces as they came.
    """
    tree_a, tree_b = (FaceTree.of(mesh.vertices.copy(), mesh.faces.copy()) for mesh in (a, b))
    contacts = find_contacts(tree_a, tree_b, gap_mm)
    crossings = []
    for mesh, other, near, within in zip(
        (a, b), (tree_b, tree_a), contacts, (relation == "inside", relation == "around"), strict=True
    ):
        inside = are_vertices_inside(mesh.vertices, mesh.faces, other, near.faces)
        wrong = np.flatnonzero(inside != within)
        if len(wrong):
            crossings.append(_deepest_crossing(mesh, other, wrong))
    if not crossings:
        return None
    lengths = [longest_edges(mesh.vertices, mesh.faces[near.faces]) for mesh, near in zip((a, b), contacts, strict=True)]
    longest_mm = float(np.concatenate(lengths).max(initial=0.0))
    edge_mm, depth_mm = min((width * np.sqrt(gap_mm / (depth + gap_mm)), depth) for width, depth in crossings)
    return EdgeNeeded(float(edge_mm), longest_mm, depth_mm) if edge_mm < longest_mm else None


def _deepest_crossing(mesh: Mesh, other: FaceTree, wrong: Ints) -> tuple[float, float]:
    """(width, depth) mm around the vertex farthest on the wrong side, out to the first vertices that are not."""
    depths = closest_points_in(other, mesh.vertices[wrong])[0]
    deepest = int(depths.argmax())
    ends = edges(mesh.faces).ends
    linked = ends[np.isin(ends, wrong).all(axis=1)]
    label = label_connected(len(wrong), *np.searchsorted(wrong, linked).T)[1]
    patch = wrong[label == label[deepest]]
    ring = np.unique(mesh.faces[np.isin(mesh.faces, patch).any(axis=1)])
    reach = np.linalg.norm(mesh.vertices[ring] - mesh.vertices[wrong[deepest]], axis=1).max()
    return 2.0 * float(reach), float(depths[deepest])
