"""One surface thinned to its plan: rounds of collapses, each followed by smoothing where they were."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.decimation.box_tree import fit_boxes
from core.decimation.collapse import REASONS, Guards, Scratch
from core.decimation.nearness import Nearness
from core.decimation.plan import Plan
from core.decimation.room import Obstacles
from core.decimation.smooth_near import smooth_dirty, spread_to_neighbours
from core.decimation.state import GONE, State, alive, begin
from core.decimation.thin import thin
from core.mesh import Mesh
from core.run import RunContext

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

ROUND = 0.25  # a round leaves at least this share of the faces; then vertices are smoothed and boxes made tight again
LEAST_QUALITIES = (0.1, 0.03, 0.005)  # of new faces; the lower ones only if nothing else leads to the target
WORTH = 0.001  # a round that removes less than this share of the faces goes on to the next least quality


@dataclass(frozen=True, eq=False, slots=True)
class Means:
    """How to thin. by_curvature: else by quadric. own_mm: distance kept between faces of the surface that share no corner."""

    by_curvature: bool
    smooth_weight: float
    own_mm: float
    obstacles: Obstacles
    thorough: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class Thinned:
    """The result. stand_in: (V,) for each vertex of the original the one of the result that took it in.

    attempts: how often a collapse was refused, by reason, and how often done.
    """

    mesh: Mesh
    stand_in: Ints
    attempts: dict[str, int]


def thinned(mesh: Mesh, plan: Plan, locked: Flags, nearness: Nearness, means: Means, run: RunContext) -> Thinned:
    """Thin a closed manifold without unused vertices, coordinates exact in float32; locked: (V,) vertices that stay.

    Keeps closed manifold and genus. Crossings are left to the exact test of the caller, who may ask to be `thorough`.
    """
    state, numbering = begin(mesh, plan.label, plan.room, plan.fixed | locked)
    if nearness.asked:
        nearness = nearness._replace(
            limits_mm=nearness.limits_mm[numbering.vertex], members=np.ascontiguousarray(mesh.vertices[numbering.vertex])
        )
    scratch, counts = Scratch.of(state), np.zeros(len(REASONS), dtype=np.int64)
    left = first = len(mesh.faces)
    # a number of faces is worth slivers if nothing else leads to it, a deviation is not
    for least_quality in LEAST_QUALITIES[:1] if nearness.asked else LEAST_QUALITIES:
        guards = Guards(least_quality, means.own_mm, means.thorough)
        while left > plan.goal:
            goal = max(plan.goal, int(ROUND * left))
            before = left
            left = thin(state, goal, left, means.by_curvature, guards, means.obstacles, nearness, scratch, counts)
            if means.smooth_weight > 0.0:
                spread_to_neighbours(state)
                smooth_dirty(state, means.smooth_weight, guards, means.obstacles, nearness, scratch)
                state.dirty[:] = False
            fit_boxes(state.points, state.ids, state.boxes)
            run.advance((first - left) / max(first - plan.goal, 1), f"{left:,} faces")
            if before - left <= WORTH * before:
                break
    return _collect(state, numbering.vertex, counts)


def _collect(state: State, vertex: Ints, counts: Ints) -> Thinned:
    """Number what is left; the order of faces follows the space-filling curve."""
    faces = state.ids.reshape(-1, 3)[alive(state)]
    remain = np.flatnonzero(state.corner_of != GONE)
    rank = np.full(len(state.points), -1, dtype=np.int64)
    rank[remain] = np.arange(len(remain))
    taker = state.merged_into.astype(np.int64)
    while True:
        further = taker[taker]
        if np.array_equal(further, taker):
            break
        taker = further
    stand_in = np.full(int(vertex.max()) + 1, -1, dtype=np.int64)
    stand_in[vertex] = rank[taker]
    return Thinned(Mesh.of(state.points[remain], rank[faces]), stand_in, dict(zip(REASONS, counts.tolist(), strict=True)))
