"""Move one surface to its depth below the skin without ever passing through a state that breaks the clearance."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.clearance import Clearance, MovingSurface
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_crosses
from core.geometry.quality import quality
from core.mesh import Faces, Vertices
from core.run import RunContext
from core.shells.reconnect import Remedy, reconnect
from core.shells.sheet import Sheet

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
    patience: int = 3  # rounds in a row without a move worth it after which a vertex rests until edges change
    worth_mm: float = 0.02
    depth_tolerance: float = 0.02  # relative; corrected further while outside
    poor_quality: float = 0.25  # q below which a face's corners are smoothed
    least_quality: float = 0.05  # no step may take q below this, or lower where it is below
    reconnect_every: int = 4  # rounds
    remedy: Remedy = field(default_factory=Remedy)
    lost_quality: float = 0.8  # share of its q that a face poorer than that may lose at the outset


PACE = Pace()


@dataclass(frozen=True, eq=False, slots=True)
class Surroundings:
    """What a layer moves between: the skin its depth is measured from, and the clearance it keeps."""

    skin: FaceTree
    clearance: Clearance

    def depth(self, points: Floats) -> tuple[Floats, Floats]:
        """Distance to the skin (N,) mm and direction away from it (N, 3)."""
        distance, foot, _face = closest_points_in(self.skin, points)
        return distance, (points - foot) / np.maximum(distance, 1e-9)[:, None]


def advance(start: Sheet, goal: Vertices, depth_mm: Floats, around: Surroundings, run: RunContext, pace: Pace = PACE) -> Sheet:
    """From `start`, which keeps the clearance, as near to a depth below the skin as the clearance allows.

    goal: (N, 3) mm, one place per vertex of the start, a first guess that may break anything. depth_mm: (V,) wanted below
    each skin vertex. Where the sheet is compressed its connectivity changes.
    Promises: the result keeps the clearance, like every state on the way; closed manifold of the same genus.
    Source: thesis Eq. (4.1) and 5.2 (move, check, repair locally), with the check inside the loop.
    """
    surface = MovingSurface(start.vertices, start.net.faces)
    sheet = start.at(_jump(start, goal, surface, around.clearance, pace))
    state = _State.of(sheet, surface, depth_mm, around.depth(sheet.vertices)[0])
    for count in range(pace.rounds):
        if count % pace.reconnect_every == pace.reconnect_every - 1:
            sheet, surface, changed = reconnect(state.sheet, state.surface, around.clearance, pace.remedy)
            if changed:
                state = _State.of(sheet, surface, depth_mm, _carried_depth(state, sheet, around))
        wanting, moved = _improve(state, around, pace)
        run.advance((count + 1) / pace.rounds, f"round {count + 1}: {wanting} vertices off depth or shape, {moved} moved")
        if moved == 0:
            break
    return state.sheet


@dataclass(slots=True)
class _State:
    """A sheet on its way. Rows per vertex: wanted_mm and depth_mm below the skin, refusals in a row. shape: q per face."""

    sheet: Sheet
    surface: MovingSurface
    wanted_mm: Floats
    depth_mm: Floats
    shape: Floats
    refused: NDArray[np.int64]

    @classmethod
    def of(cls, sheet: Sheet, surface: MovingSurface, wanted_mm: Floats, depth_mm: Floats) -> _State:
        """wanted_mm: (V,) below each skin vertex; depth_mm: (N,) as measured."""
        shape = quality(sheet.vertices, sheet.net.faces)
        return cls(sheet, surface, wanted_mm[sheet.origin], depth_mm, shape, np.zeros(sheet.net.vertex_count, dtype=np.int64))


def _carried_depth(state: _State, sheet: Sheet, around: Surroundings) -> Floats:
    """Depths of a sheet that came from the state's by reconnecting: measured anew only where a vertex moved."""
    former = state.sheet.stand_in[sheet.origin]
    depth: Floats = state.depth_mm[former]
    moved = np.flatnonzero((sheet.vertices != state.sheet.vertices[former]).any(axis=1))
    depth[moved] = around.depth(sheet.vertices[moved])[0]
    return depth


def _jump(start: Sheet, goal: Vertices, surface: MovingSurface, clearance: Clearance, pace: Pace) -> Vertices:
    """Go all the way at once, then take back, vertex by vertex, what is crowded, turned over or squeezed."""
    net = start.net
    share = np.ones(net.vertex_count)
    vertices = goal.copy()
    asked = np.arange(len(net.faces))
    least = np.minimum(pace.least_quality, pace.lost_quality * quality(start.vertices, net.faces))
    for attempt in range(pace.most_retreats):
        crowded = surface.find_crowded(vertices, asked, clearance)
        faces = net.faces[asked]
        spoiled = _is_turned(start.vertices, vertices, faces) | (quality(vertices, faces) < least[asked])
        crowded = np.union1d(crowded, asked[spoiled])
        if len(crowded) == 0:
            return vertices
        back = net.grown(net.corners_of(crowded))
        share[back] *= pace.retreat if attempt < pace.most_retreats // 2 else 0.0
        share[share < pace.smallest_share] = 0.0
        vertices = start.vertices + share[:, None] * (goal - start.vertices)
        asked = np.union1d(net.faces_of(back), crowded)
    surface.find_crowded(start.vertices, np.arange(len(net.faces)), clearance)
    return start.vertices


def _improve(state: _State, around: Surroundings, pace: Pace) -> tuple[int, int]:
    """One round of smoothing and depth correction where wanted; returns how many vertices wanted it and how many moved."""
    net, vertices = state.sheet.net, state.sheet.vertices
    patient = state.refused < pace.patience
    poor = net.grown(net.corners_of(np.flatnonzero(state.shape < pace.poor_quality)))
    off = net.grown(np.abs(state.depth_mm - state.wanted_mm) > pace.depth_tolerance * state.wanted_mm)
    wanting = (off | poor) & patient
    chosen = np.flatnonzero(wanting)
    if len(chosen) == 0:
        return 0, 0
    faces = net.faces_of(wanting)
    proposal = vertices.copy()
    _smooth(
        vertices, net.faces, net.faces_around.start, net.faces_around.values, net.neighbours.values,
        np.flatnonzero(poor & patient), pace.smoothing, proposal,
    )  # fmt: skip
    depth, away = around.depth(proposal[chosen])
    correction = np.clip(state.wanted_mm[chosen] - depth, -pace.step_mm, pace.step_mm)
    proposal[chosen] += correction[:, None] * away
    moving = _accept(state, proposal, wanting, faces, around.clearance, pace)

    moved = np.flatnonzero(moving)
    travelled = np.linalg.norm(proposal[moved] - vertices[moved], axis=1)
    state.sheet = state.sheet.at(proposal)
    state.depth_mm[moved] = around.depth(proposal[moved])[0]
    state.shape[faces] = quality(proposal, net.faces[faces])
    state.refused[wanting] += 1
    state.refused[moved[travelled > pace.worth_mm]] = 0
    return len(chosen), len(moved)


def _accept(
    state: _State, proposal: Vertices, moving: Flags, asked: NDArray[np.int64], clearance: Clearance, pace: Pace
) -> Flags:
    """Take back moves in `proposal`, in place, until it keeps clearance and quality; returns which vertices (N,) moved.

    asked: faces around the moving vertices. Ends because every pass takes at least one vertex back, and with all taken back
    the proposal is the state before.
    """
    net = state.sheet.net
    moving = moving.copy()
    least = np.minimum(state.shape, pace.least_quality) * (1 - 1e-9)
    while True:
        spoiled = quality(proposal, net.faces[asked]) < least[asked]
        broken = np.union1d(state.surface.find_crowded(proposal, asked, clearance), asked[spoiled])
        if len(broken) == 0:
            return moving
        back = net.corners_of(broken) & moving
        proposal[back] = state.sheet.vertices[back]
        moving &= ~back
        asked = net.faces_of(back)


def _is_turned(start: Vertices, vertices: Vertices, faces: Faces) -> Flags:
    """Faces (F,) whose normal points against the one they started with."""
    turned: Flags = np.einsum("ij,ij->i", face_crosses(start, faces), face_crosses(vertices, faces)) <= 0
    return turned


@njit(cache=True, nogil=True)
def _smooth(
    vertices: Floats,
    faces: Faces,
    start: NDArray[np.int64],
    around: NDArray[np.int32],
    neighbours: NDArray[np.int32],
    chosen: NDArray[np.int64],
    share: float,
    out: Floats,
) -> None:
    """Move chosen vertices by a share of the way to the mean of their neighbours, along the surface; out (V, 3)."""
    for vertex in chosen:
        x, y, z = 0.0, 0.0, 0.0
        nx, ny, nz = 0.0, 0.0, 0.0
        for i in range(start[vertex], start[vertex + 1]):
            other = neighbours[i]
            x, y, z = x + vertices[other, 0], y + vertices[other, 1], z + vertices[other, 2]
            a, b, c = faces[around[i], 0], faces[around[i], 1], faces[around[i], 2]
            ux, uy, uz = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2]
            vx, vy, vz = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2]
            nx, ny, nz = nx + uy * vz - uz * vy, ny + uz * vx - ux * vz, nz + ux * vy - uy * vx
        count = start[vertex + 1] - start[vertex]
        x, y, z = x / count - vertices[vertex, 0], y / count - vertices[vertex, 1], z / count - vertices[vertex, 2]
        length = nx * nx + ny * ny + nz * nz
        along = (x * nx + y * ny + z * nz) / length if length > 0.0 else 0.0
        out[vertex, 0] = vertices[vertex, 0] + share * (x - along * nx)
        out[vertex, 1] = vertices[vertex, 1] + share * (y - along * ny)
        out[vertex, 2] = vertices[vertex, 2] + share * (z - along * nz)
