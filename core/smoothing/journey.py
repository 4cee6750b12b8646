"""One surface from iteration to iteration: what was reached, which state was best, when to end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.distance import smallest_gap_between
from core.geometry.face_tree import FaceTree
from core.mesh import Faces, Mesh, Vertices
from core.schema.smooth import SmoothInputs
from core.smoothing.guarded_step import GuardedSurface
from core.smoothing.progress import Progress, measure_progress
from core.smoothing.proposal import Original, propose

Flags = NDArray[np.bool_]

PATIENCE = 3  # iterations in a row without a rise after which a surface rests
RISE = 1.001  # factor by which the lowest quality must grow to count as risen
LEAST_QUALITY = 0.05  # with all iterations wanted, no step takes q below this, or lower where it is below


@dataclass(slots=True)
class Journey:
    """within: (V,) vertices in the regions, rims included. best: iteration with the highest lowest quality."""

    original: Original
    state: GuardedSurface
    within: Flags
    closed: bool
    inputs: SmoothInputs
    progress: list[Progress]
    best: int
    delivered: int
    at_rest: bool
    _best_vertices: Vertices
    _best_faces: Faces

    @classmethod
    def of(cls, mesh: Mesh, tree: FaceTree, state: GuardedSurface, within: Flags, inputs: SmoothInputs) -> Journey:
        """At the start; a surface without vertices to move is at rest at once."""
        closed = bool((edges(mesh.faces).face_count == 2).all())
        first = measure_progress(0, mesh.vertices, mesh.vertices, mesh.faces, state.faces_asked, closed=closed)
        rests = len(state.chosen) == 0
        original = Original(mesh.vertices, tree)
        return cls(original, state, within, closed, inputs, [first], 0, 0, rests, mesh.vertices, mesh.faces)

    def tree(self) -> FaceTree:
        """Of the surface as it is now."""
        return FaceTree.of(self.state.vertices, self.state.net.faces)

    def go(self, iteration: int, others: tuple[FaceTree, ...]) -> None:
        """One iteration between other surfaces; comes to rest where nothing is gained."""
        state, inputs = self.state, self.inputs
        proposal = propose(state.vertices, self.original, state.net, state.chosen, inputs)
        rising = inputs.stop == "quality"
        step = state.step(proposal, others, self.progress[-1].lowest_quality if rising else LEAST_QUALITY)
        flipped = state.flip(self.within, others) if inputs.retriangulate else 0
        now = measure_progress(
            iteration, state.vertices, self.original.vertices, state.net.faces, state.faces_asked,
            closed=self.closed, moved=step.moved, shortened=step.shortened, held=step.held, flipped=flipped,
        )  # fmt: skip
        self.progress.append(now)
        self.delivered = iteration
        if now.lowest_quality > RISE * self.progress[self.best].lowest_quality:
            self.best, self._best_vertices, self._best_faces = iteration, state.vertices, state.net.faces
        nothing_moves = step.moved == 0 and flipped == 0
        if nothing_moves or (rising and iteration - self.best >= PATIENCE):
            self.at_rest = True
            self.arrive(others)

    def arrive(self, others: tuple[FaceTree, ...]) -> None:
        """Go back to the best state, if that is what is wanted and the other surfaces have left room for it."""
        if self.inputs.stop != "quality" or self.delivered == self.best:
            return
        then = FaceTree.of(self._best_vertices, self._best_faces)
        if all(smallest_gap_between(then, other).distance_mm >= self.inputs.min_gap_mm for other in others):
            self.state.place(self._best_vertices, self._best_faces)
            self.delivered = self.best
