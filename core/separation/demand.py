"""Where and how far the vertices of a tissue must go to open the gap to another one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.containment import is_inside
from core.geometry.distance import closest_points_in
from core.separation.contacts import Contacts
from core.separation.relations import Relation
from core.separation.tissue import Tissue

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

OPENING_COSINE = 0.5  # Eq. 4.1's direction is taken if it opens the gap within 60 degrees
CROSSING_SHARE = 0.5  # of the gap, for a face that crosses while all its corners are on their side: nobody knows how deep
NO_DIRECTION_MM = 1e-6  # nearer to the other surface, the way to it says nothing


@dataclass(frozen=True, eq=False, slots=True)
class Demand:
    """vertices: (K,) ascending. ways: (K, 3) mm, how far each must go. wrong: (L,) those on the wrong side of the other."""

    vertices: Ints
    ways: Floats
    wrong: Ints


def find_demand(tissue: Tissue, other: Tissue, relation: Relation, contacts: Contacts, wrong: Ints, goal_mm: float) -> Demand:
    """What opens `goal_mm` between a tissue and another one, if the tissue goes all the way alone.

    relation: what the tissue is to the other. contacts: its faces too close to the other. wrong: (L,) vertices that were on the
    wrong side a step ago; only they and the corners of contacts can be there now.
    """
    faces = tissue.original.faces
    asked = np.union1d(wrong, faces[contacts.faces].ravel()).astype(np.int64)
    if len(asked) == 0:
        return Demand(asked, np.empty((0, 3)), asked)
    places = tissue.vertices[asked]
    distance, foot, _face = closest_points_in(other.tree, places)
    astray = is_inside(other.tree, places) != (relation == "inside")
    sign = np.where(astray, -1.0, 1.0)
    need = np.maximum(goal_mm - sign * distance, 0.0)
    outward = tissue.opening_directions()[asked]
    own = outward if relation == "around" else -outward
    away = sign[:, None] * (places - foot) / np.maximum(distance, NO_DIRECTION_MM)[:, None]
    away[distance < NO_DIRECTION_MM] = 0.0
    need = np.maximum(need, _needs_of_faces(tissue, contacts, asked, goal_mm))
    ways = need[:, None] * _directions(own, away)
    some = need > 0.0
    return Demand(asked[some], ways[some], asked[astray])


def _directions(own: Floats, away: Floats) -> Floats:
    """Eq. 4.1's direction where it opens the gap, else one between it and the way from the closest point."""
    length = np.linalg.norm(own, axis=1)
    unit = own / np.maximum(length, 1e-12)[:, None]
    cosine = np.einsum("ij,ij->i", unit, away)
    between = unit + away
    between /= np.maximum(np.linalg.norm(between, axis=1), 1e-12)[:, None]
    known = (away != 0.0).any(axis=1)
    slanting = known & (cosine > 0.0) & (cosine < OPENING_COSINE)
    # a vertex with no normal of its own has only the closest point to go by
    return np.where(slanting[:, None], between, np.where((length > 0.0)[:, None], own, away))


def _needs_of_faces(tissue: Tissue, contacts: Contacts, asked: Ints, goal_mm: float) -> Floats:
    """How far corners (K,) must go because a place within a face is too close: least squares over its three corners."""
    corners = tissue.original.faces[contacts.faces]
    crossing = contacts.distance_mm == 0.0
    missing = np.where(crossing, CROSSING_SHARE * goal_mm, goal_mm - contacts.distance_mm)
    weights = _barycentric(tissue.vertices[corners], contacts.points)
    weights /= np.einsum("ij,ij->i", weights, weights)[:, None]
    needs = np.zeros(len(asked))
    np.maximum.at(needs, np.searchsorted(asked, corners.ravel()), (missing[:, None] * weights).ravel())
    return needs


def _barycentric(corners: Floats, points: Floats) -> Floats:
    """Weights (K, 3), 0 to 1, of the places of triangles (K, 3, 3) under points (K, 3)."""
    u, v, w = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    uu, vv, uv = (np.einsum("ij,ij->i", p, q) for p, q in ((u, u), (v, v), (u, v)))
    wu, wv = np.einsum("ij,ij->i", w, u), np.einsum("ij,ij->i", w, v)
    determinant = np.maximum(uu * vv - uv * uv, 1e-300)
    of_b, of_c = (vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant
    weights = np.clip(np.column_stack((1.0 - of_b - of_c, of_b, of_c)), 0.0, 1.0)
    total = weights.sum(axis=1)
    weights[total <= 0.0], total[total <= 0.0] = 1.0, 3.0
    result: Floats = weights / total[:, None]
    return result
