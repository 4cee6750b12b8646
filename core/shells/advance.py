"""Move one surface to its depth below the skin without ever passing through a state that breaks the clearance."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.geometry.clearance import Clearance, MovingSurface
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_crosses
from core.geometry.quality import quality
from core.mesh import Faces, Vertices
from core.run import SILENT, RunContext
from core.shells.better_place import better_places
from core.shells.independent_sets import independent_sets
from core.shells.innate_quality import find_poor, innate_quality
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
    shortening: float = 0.5  # of a vertex's next move, for every refusal
    step_mm: float = 0.15  # furthest correction of the depth in one round ...
    step_share: float = 0.1  # ... or this share of the depth, if that is more
    rounds: int = 20
    patience: int = 4  # rounds in a row without a move worth it after which a vertex rests until edges change
    worth_mm: float = 0.02  # nearer to the depth ...
    worth_quality: float = 0.02  # ... or better in q, which makes a move worth it
    depth_tolerance: float = 0.01  # relative; corrected further while outside
    poor_quality: float = 0.25  # q below which a face's corners are smoothed
    least_quality: float = 0.1  # no step may take q below this, or lower where it is below
    reconnect_every: int = 4  # rounds
    remedy: Remedy = field(default_factory=Remedy)
    lost_quality: float = 0.8  # share of its q that a face poorer than that may lose at the outset


PACE = Pace()
MENDING = Pace(rounds=8, reconnect_every=2)


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
    return _settle(state, depth_mm, innate_quality(start), around, run, pace)


def mend(sheet: Sheet, surface: MovingSurface, outer: Sheet, around: Surroundings) -> Sheet:
    """The sheet where it is, its faces better shaped where they are worse than those of the sheet outside it.

    sheet: keeps the clearance, and so does what comes back. surface: follows it.
    """
    depth = around.depth(sheet.vertices)[0]
    state = _State.of(sheet, surface, depth[sheet.stand_in], depth)
    return _settle(state, depth[sheet.stand_in], innate_quality(outer), around, SILENT, MENDING)


def _settle(state: _State, depth_mm: Floats, innate: Floats, around: Surroundings, run: RunContext, pace: Pace) -> Sheet:
    """Rounds of moves and of changes of edges until nothing moves."""
    idle = False
    for count in range(pace.rounds):
        due = idle or count % pace.reconnect_every == pace.reconnect_every - 1
        if due:
            sheet, surface, changed = reconnect(state.sheet, state.surface, around.clearance, pace.remedy, innate)
            if changed:
                state = state.reconnected(sheet, surface, depth_mm, around)
        wanting, moved = _improve(state, around, pace, innate)
        run.advance((count + 1) / pace.rounds, f"round {count + 1}: {wanting} vertices off depth or shape, {moved} moved")
        idle = moved == 0
        if idle and due:
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

    def reconnected(self, sheet: Sheet, surface: MovingSurface, wanted_mm: Floats, around: Surroundings) -> _State:
        """The state of a sheet that came from this one's: depths are measured only, and refusals forgotten, where it changed."""
        former = self.sheet.stand_in[sheet.origin]
        after = _State.of(sheet, surface, wanted_mm, self.depth_mm[former])
        moved = np.flatnonzero((sheet.vertices != self.sheet.vertices[former]).any(axis=1))
        after.depth_mm[moved] = around.depth(sheet.vertices[moved])[0]
        now, before = sheet.net.faces_around.start, self.sheet.net.faces_around.start
        changed = np.diff(now) != np.diff(before)[former]  # a flip or a collapse changes how many faces a vertex has
        changed[moved] = True
        after.refused[:] = np.where(sheet.net.grown(changed), 0, self.refused[former])
        return after


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


def _improve(state: _State, around: Surroundings, pace: Pace, innate: Floats) -> tuple[int, int]:
    """One round of smoothing and depth correction where wanted; returns how many vertices wanted it and how many moved."""
    net, vertices = state.sheet.net, state.sheet.vertices
    patient = state.refused < pace.patience
    poor = net.grown(net.corners_of(find_poor(state.sheet, state.shape, pace.poor_quality, innate)))
    off = np.abs(state.depth_mm - state.wanted_mm) > pace.depth_tolerance * state.wanted_mm
    wanting = (off | poor) & patient
    chosen = np.flatnonzero(wanting)
    if len(chosen) == 0:
        return 0, 0
    faces = net.faces_of(wanting)
    proposal = vertices.copy()
    uneven = np.flatnonzero(poor & patient)
    share = pace.shortening**state.refused
    proposal[uneven] += share[uneven, None] * (better_places(vertices, net, uneven) - vertices[uneven])
    depth, away = around.depth(proposal[chosen])
    step = share[chosen] * np.maximum(pace.step_mm, pace.step_share * state.wanted_mm[chosen])
    correction = np.clip(state.wanted_mm[chosen] - depth, -step, step)
    proposal[chosen] += correction[:, None] * away
    wish = proposal.copy()
    moving = _accept(state, proposal, wanting, faces, around.clearance, pace)
    # one vertex that cannot move takes its neighbours' moves back with it: try those by themselves
    for alone in independent_sets(net, wanting & ~moving):
        proposal[alone] = wish[alone]
        one_by_one = np.zeros(net.vertex_count, dtype=np.bool_)
        one_by_one[alone] = True
        moving |= _accept(state, proposal, one_by_one, net.faces_of(one_by_one), around.clearance, pace)

    moved = np.flatnonzero(moving)
    error = np.abs(state.depth_mm - state.wanted_mm)
    state.sheet = state.sheet.at(proposal)
    state.depth_mm[moved] = around.depth(proposal[moved])[0]
    gained = error - np.abs(state.depth_mm - state.wanted_mm) > pace.worth_mm
    shape = quality(proposal, net.faces[faces])
    better = faces[(shape > state.shape[faces] + pace.worth_quality) & (state.shape[faces] < pace.poor_quality)]
    gained |= net.corners_of(better)
    state.shape[faces] = shape
    state.refused[wanting] += 1
    state.refused[gained] = 0
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
