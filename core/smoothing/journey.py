"""One surface from iteration to iteration: what was reached, which state was best, when to end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.distance import smallest_gap_between
from core.geometry.face_tree import FaceTree
from core.mesh import Faces, Mesh, Vertices
from core.schema.smooth import SmoothInputs
from core.smoothing.company import Company
from core.smoothing.guarded_step import GuardedSurface, Step
from core.smoothing.progress import Progress, measure_progress
from core.smoothing.proposal import Original, propose

Flags = NDArray[np.bool_]

PATIENCE = 3  # iterations in a row without a rise after which a surface rests
RISE = 1.001  # factor by which the lowest quality must grow to count as risen
JUMP_SHORTENING = 0.5  # of a whole step that would take a piece through another
SMALLEST_JUMP = 0.1  # below, the surface stays where it is
LEAST_QUALITY = 0.05  # with all iterations wanted, no step takes q below this, or lower where it is below


@dataclass(slots=True)
class Journey:
    """within: (V,) vertices in the regions, rims included. best: iteration with the highest lowest quality."""

    name: str
    original: Original
    company: Company
    state: GuardedSurface
    within: Flags
    inputs: SmoothInputs
    progress: list[Progress]
    best: int
    delivered: int
    at_rest: bool
    _best_vertices: Vertices
    _best_faces: Faces

    @classmethod
    def of(cls, name: str, mesh: Mesh, company: Company, state: GuardedSurface, within: Flags, inputs: SmoothInputs) -> Journey:
        """At the start; a surface without vertices to move is at rest at once."""
        closed = company.is_closed(name)
        vertices, faces = state.vertices, state.net.faces
        first = measure_progress(0, vertices, vertices, faces, state.faces_asked, closed=closed)
        original, rests = Original(mesh.vertices, company.tree(name)), len(state.chosen) == 0
        return cls(name, original, company, state, within, inputs, [first], 0, 0, rests, vertices, faces)

    def go(self, iteration: int) -> None:
        """One iteration among the company; comes to rest where nothing is gained."""
        state, inputs = self.state, self.inputs
        rising = inputs.stop == "quality"
        step = self._step(self.progress[-1].lowest_quality if rising else LEAST_QUALITY)
        flipped = state.flip(self.within, self.company.others(self.name)) if inputs.retriangulate else 0
        now = measure_progress(
            iteration, state.vertices, self.original.vertices, state.net.faces, state.faces_asked,
            closed=self.company.is_closed(self.name),
            moved=step.moved, shortened=step.shortened, held=step.held, flipped=flipped,
        )  # fmt: skip
        self.progress.append(now)
        self.delivered = iteration
        if now.lowest_quality > RISE * self.progress[self.best].lowest_quality:
            self.best, self._best_vertices, self._best_faces = iteration, state.vertices, state.net.faces
        nothing_moves = step.moved == 0 and flipped == 0
        if nothing_moves or (rising and iteration - self.best >= PATIENCE):
            self.at_rest = True
            self.arrive()

    def arrive(self) -> None:
        """Go back to the best state, if that is what is wanted and the other surfaces have left room for it."""
        if self.inputs.stop != "quality" or self.delivered == self.best:
            return
        then = FaceTree.of(self._best_vertices, self._best_faces)
        others = self.company.others(self.name)
        if all(smallest_gap_between(then, other).distance_mm >= self.inputs.min_gap_mm for other in others) and (
            self.company.admits(self.name, self._best_vertices, self._best_faces)
        ):
            self.state.place(self._best_vertices, self._best_faces)
            self.delivered = self.best

    def _step(self, lowest_quality: float) -> Step:
        """As far as it goes at once without a piece jumping through another."""
        state = self.state
        here = state.vertices
        proposal = propose(here, self.original, state.net, state.chosen, self.inputs)
        others, share = self.company.others(self.name), 1.0
        while True:
            step = state.step(here + share * (proposal - here), others, lowest_quality)
            if self.company.admits(self.name, state.vertices, state.net.faces):
                return step
            state.place(here, state.net.faces)
            share = share * JUMP_SHORTENING if share > SMALLEST_JUMP else 0.0
