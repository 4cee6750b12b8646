"""Move one surface to its depth below the skin without ever passing through a state that breaks the clearance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.adjacency import Rows
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_crosses, vertex_normals
from core.geometry.quality import quality
from core.mesh import Faces, Vertices
from core.run import RunContext
from core.shells.clearance import Clearance, MovingSurface

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Pace:
    """How a surface is moved; the defaults were measured on full bodies."""

    retreat: float = 0.6  # a crowded vertex falls back to this share of its way
    smallest_share: float = 0.02  # below, it goes back to the start altogether
    most_retreats: int = 60
    smoothing: float = 0.3  # share of the way to the middle of the neighbours, along the surface
    step_mm: float = 0.15  # furthest correction of the depth in one round
    rounds: int = 20
    depth_tolerance: float = 0.02  # relative; corrected further while outside
    poor_quality: float = 0.25  # q below which a face's corners are smoothed
    least_quality: float = 0.05  # no step may take q below this, or lower where it is below
    lost_quality: float = 0.8  # share of its q that a face poorer than that may lose at the outset


PACE = Pace()


@dataclass(frozen=True, eq=False, slots=True)
class Surroundings:
    """What stays the same while the layers of one skin are made."""

    skin: FaceTree
    faces: Faces
    faces_around: Rows
    neighbours: Rows
    surface: MovingSurface

    def depth(self, points: Floats) -> tuple[Floats, Floats]:
        """Distance to the skin (N,) mm and direction away from it (N, 3)."""
        distance, foot, _face = closest_points_in(self.skin, points)
        return distance, (points - foot) / np.maximum(distance, 1e-9)[:, None]

    def faces_of(self, vertices: Flags) -> NDArray[np.int64]:
        """Numbers of the faces with a corner among the vertices (V,)."""
        return np.flatnonzero(vertices[self.faces].any(axis=1))

    def corners_of(self, faces: NDArray[np.int64]) -> Flags:
        """The vertices of some faces, as flags (V,)."""
        flags = np.zeros(len(self.faces_around.start) - 1, dtype=np.bool_)
        flags[self.faces[faces].ravel()] = True
        return flags

    def grown(self, vertices: Flags) -> Flags:
        """The vertices and their neighbours."""
        return self.corners_of(self.faces_of(vertices)) if vertices.any() else vertices


def advance(
    start: Vertices,
    goal: Vertices,
    depth_mm: Floats,
    around: Surroundings,
    clearance: Clearance,
    run: RunContext,
    pace: Pace = PACE,
) -> Vertices:
    """From `start`, which keeps the clearance, as near to `depth_mm` (V,) below the skin as the clearance allows.

    start, goal: (V, 3) mm; the goal is a first guess and may break anything.
    Returns (V, 3) mm; keeps the clearance, like every state on the way.
    Source: thesis Eq. (4.1) and 5.2 (move, check, repair locally), with the check inside the loop.
    """
    vertices = _jump(start, goal, around, clearance, pace)
    for count in range(pace.rounds):
        vertices, wanting, moved = _improve(vertices, depth_mm, around, clearance, pace)
        run.advance((count + 1) / pace.rounds, f"round {count + 1}: {wanting} vertices off depth or shape, {moved} moved")
        if moved == 0:
            break
    return vertices


def _jump(start: Vertices, goal: Vertices, around: Surroundings, clearance: Clearance, pace: Pace) -> Vertices:
    """Go all the way at once, then take back, vertex by vertex, what is crowded or turned over."""
    share = np.ones(len(start))
    vertices = goal.copy()
    asked = np.arange(len(around.faces))
    shape = np.minimum(pace.least_quality, pace.lost_quality * quality(start, around.faces))
    for attempt in range(pace.most_retreats):
        crowded = around.surface.find_crowded(vertices, asked, clearance)
        spoiled = _is_turned(start, vertices, around.faces[asked]) | (quality(vertices, around.faces[asked]) < shape[asked])
        crowded = np.union1d(crowded, asked[spoiled])
        if len(crowded) == 0:
            return vertices
        back = around.grown(around.corners_of(crowded))
        share[back] *= pace.retreat if attempt < pace.most_retreats // 2 else 0.0
        share[share < pace.smallest_share] = 0.0
        vertices = start + share[:, None] * (goal - start)
        asked = np.union1d(around.faces_of(back), crowded)
    around.surface.find_crowded(start, np.arange(len(around.faces)), clearance)
    return start


def _improve(
    vertices: Vertices, depth_mm: Floats, around: Surroundings, clearance: Clearance, pace: Pace
) -> tuple[Vertices, int, int]:
    """One round of smoothing and depth correction where wanted; returns the new vertices, how many were wanting and moved."""
    depth, away = around.depth(vertices)
    before = quality(vertices, around.faces)
    poor = around.grown(around.corners_of(np.flatnonzero(before < pace.poor_quality)))
    wanting = around.grown(np.abs(depth - depth_mm) > pace.depth_tolerance * depth_mm) | poor
    chosen = np.flatnonzero(wanting)
    if len(chosen) == 0:
        return vertices, 0, 0
    proposal = vertices.copy()
    normals = vertex_normals(vertices, around.faces, "area")
    smoothed = np.flatnonzero(poor)
    _smooth(vertices, normals, around.neighbours.start, around.neighbours.values, smoothed, pace.smoothing, proposal)
    depth, away = around.depth(proposal[chosen])
    correction = np.clip(depth_mm[chosen] - depth, -pace.step_mm, pace.step_mm)
    proposal[chosen] += correction[:, None] * away
    moved = _accept(vertices, proposal, wanting, before, around, clearance, pace)
    return proposal, len(chosen), moved


def _accept(
    vertices: Vertices,
    proposal: Vertices,
    moving: Flags,
    before: Floats,
    around: Surroundings,
    clearance: Clearance,
    pace: Pace,
) -> int:
    """Take back moves in `proposal`, in place, until it keeps clearance and quality; returns how many vertices moved.

    Ends because every pass takes at least one vertex back, and with all taken back the proposal is the state before.
    """
    moving = moving.copy()
    asked = around.faces_of(moving)
    while True:
        shape = quality(proposal, around.faces[asked])
        spoiled = shape < np.minimum(before[asked], pace.least_quality) * (1 - 1e-9)
        broken = np.union1d(around.surface.find_crowded(proposal, asked, clearance), asked[spoiled])
        if len(broken) == 0:
            return int(moving.sum())
        back = around.corners_of(broken) & moving
        proposal[back] = vertices[back]
        moving &= ~back
        asked = around.faces_of(back)


def _is_turned(start: Vertices, vertices: Vertices, faces: Faces) -> Flags:
    """Faces (F,) whose normal points against the one they started with."""
    turned: Flags = np.einsum("ij,ij->i", face_crosses(start, faces), face_crosses(vertices, faces)) <= 0
    return turned


@njit(cache=True, nogil=True)
def _smooth(
    vertices: Floats,
    normals: Floats,
    start: NDArray[np.int64],
    values: NDArray[np.int32],
    chosen: NDArray[np.int64],
    share: float,
    out: Floats,
) -> None:
    """Move chosen vertices by a share of the way to the mean of their neighbours, along the surface; out (V, 3)."""
    for vertex in chosen:
        x, y, z = 0.0, 0.0, 0.0
        for i in range(start[vertex], start[vertex + 1]):
            other = values[i]
            x, y, z = x + vertices[other, 0], y + vertices[other, 1], z + vertices[other, 2]
        count = start[vertex + 1] - start[vertex]
        x, y, z = x / count - vertices[vertex, 0], y / count - vertices[vertex, 1], z / count - vertices[vertex, 2]
        nx, ny, nz = normals[vertex, 0], normals[vertex, 1], normals[vertex, 2]
        along = x * nx + y * ny + z * nz
        out[vertex, 0] = vertices[vertex, 0] + share * (x - along * nx)
        out[vertex, 1] = vertices[vertex, 1] + share * (y - along * ny)
        out[vertex, 2] = vertices[vertex, 2] + share * (z - along * nz)
