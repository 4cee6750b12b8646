"""From a defective surface to a closed one: a fixed sequence of small stages, each of which leaves a fit surface alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.healing.change import Change, Staged
from core.healing.coincident import drop_doubled_faces, drop_flat_faces, join_equal_vertices
from core.healing.cracks import join_cracks
from core.healing.enclosed_volume import piece_volumes
from core.healing.fitness import find_faults
from core.healing.holes import fill_holes
from core.healing.intersections.resolve import resolve
from core.healing.limits import find_former, measure_extent, require_within
from core.healing.nonmanifold_edges import mend_nonmanifold_edges
from core.healing.orientation import agree, agree_within_sheets, face_outward
from core.healing.pieces import drop_pieces, drop_scraps, find_unwanted, require_faces
from core.healing.pinched_vertices import part_pinched_vertices
from core.healing.staircase import smooth_steps
from core.healing.t_junctions import split_sides_at_vertices
from core.mesh import Faces, Mesh, Vertices
from core.run import SILENT, RunContext
from core.schema.finding import Finding
from core.schema.heal import HealParameters
from core.validation.measure import significant

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Stage = Callable[[Vertices, Faces], Staged]

ROUNDS = 5  # mending one fault may lay open another


@dataclass(frozen=True, eq=False, slots=True)
class Healed:
    """The mended surface and what was done.

    former: (F,) face of the input with its corners at the same places, whichever way it looked, or -1. changes: plain
    facts, in the order in which they were made. findings: what a reader should know.
    """

    mesh: Mesh
    former: Ints
    changes: tuple[dict[str, Any], ...]
    findings: tuple[Finding, ...]


def heal(mesh: Mesh, inputs: HealParameters, run: RunContext = SILENT) -> Healed:
    """Mend a surface with the smallest change.

    Needs:    nothing of its shape.
    Promises: closed, edge- and vertex-manifold, outward, exactly free of self-intersection, coordinates exact in float32; faces
              away from faults keep their corners bit for bit; a fit surface comes back as it is; same input, same bytes.
    Raises:   InputError `heal.nothing_left`, `heal.open_sheet`, `heal.one_sided`, `heal.hole_too_large`,
              `heal.holes_not_allowed`, `heal.changes_too_much`, `heal.not_resolved`.
    Source:   the stages name theirs."""
    before, changes = _rounded(mesh)
    run.stage("heal: look for faults", 0.0, 0.1)
    if not changes and _is_fit(before, inputs):
        return Healed(mesh, np.arange(len(mesh.faces)), (), ())
    draft = _Draft(before.vertices, before.faces, changes)
    draft.mend(inputs, run.stage("heal: mend", 0.1, 0.9))
    after = draft.compact()
    run.stage("heal: prove", 0.9, 1.0)
    _require_fit(after)
    former = find_former(before, after)
    volume = float(piece_volumes(after.vertices, after.faces).sum())
    extent = measure_extent(before, after, former, draft.changes, (*draft.volume_range, volume))
    require_within(extent, inputs)
    summary = {
        "kind": "extent",
        "message": f"{extent.faces_kept} of {len(before.faces)} faces kept their corners bit for bit",
        "faces_kept": extent.faces_kept,
        "area_taken": significant(extent.area_taken),
        "area_added": significant(extent.area_added),
        "volume_change": significant(extent.volume_change),
        "lost_mm": significant(extent.lost_mm),
        "gained_mm": significant(extent.gained_mm),
    }
    return Healed(after, former, (*(change.facts() for change in draft.changes), summary), ())


class _Draft:
    """The surface on its way through the stages."""

    def __init__(self, vertices: Vertices, faces: Faces, changes: list[Change]) -> None:
        self.vertices, self.faces, self.changes = vertices, faces, changes
        self.volume_range = (0.0, 0.0)

    def mend(self, inputs: HealParameters, run: RunContext) -> None:
        """Round after round of all stages, until no round changes anything that matters."""
        for number in range(ROUNDS):
            step = run.stage("heal: mend", number / ROUNDS, (number + 1) / ROUNDS)
            self._close(inputs, measure_volume=number == 0)
            step.advance(0.3, f"{len(self.faces)} faces, closed")
            self._apply(face_outward)
            self.vertices, self.faces, changes = resolve(
                self.vertices, self.faces, step.stage("heal: intersections", 0.3, 0.9), inputs.max_deviation_mm
            )
            self.changes += changes
            self._apply(partial(drop_pieces, policy=inputs.pieces, min_share=inputs.min_piece_share))
            if not find_faults(self.compact()):
                break
        if inputs.staircase:
            self._apply(partial(smooth_steps, max_mm=inputs.staircase_max_mm))

    def _close(self, inputs: HealParameters, measure_volume: bool) -> None:
        """Everything that makes a closed oriented manifold."""
        self._join(inputs.weld_tolerance_mm)
        self._apply(agree_within_sheets)
        self._apply(mend_nonmanifold_edges)
        # no cracks here: what was parted would be joined again
        for stage in (drop_flat_faces, drop_doubled_faces, agree):
            self._apply(stage)
        self._apply(partial(drop_scraps, policy=inputs.pieces))
        if measure_volume:
            volumes = np.abs(piece_volumes(self.vertices, self.faces))
            # further pieces may be parts, of which some is swallowed, or cavities
            self.volume_range = float(2.0 * volumes.max() - volumes.sum()), float(volumes.sum())
        self._apply(partial(fill_holes, allowed=inputs.fill_holes, max_hole_mm=inputs.max_hole_mm))
        self._apply(part_pinched_vertices)

    def _join(self, tolerance_mm: float | None) -> None:
        for stage in (
            join_equal_vertices,
            drop_flat_faces,
            partial(join_cracks, tolerance_mm=tolerance_mm),
            drop_doubled_faces,
            split_sides_at_vertices,
            drop_flat_faces,
            drop_doubled_faces,
        ):
            self._apply(stage)

    def _apply(self, stage: Stage) -> None:
        require_faces(self.faces)
        self.vertices, self.faces, changes = stage(self.vertices, self.faces)
        self.changes += changes

    def compact(self) -> Mesh:
        """The mesh without vertices of no face; the others keep their order."""
        require_faces(self.faces)
        used, corners = np.unique(self.faces, return_inverse=True)
        return Mesh.of(self.vertices[used], corners.reshape(-1, 3))


def _rounded(mesh: Mesh) -> tuple[Mesh, list[Change]]:
    """The mesh as float32 files hold it."""
    rounded = mesh.rounded_to_float32()
    moved = np.flatnonzero((rounded.vertices != mesh.vertices).any(axis=1))
    if len(moved) == 0:
        return mesh, []
    distances = np.linalg.norm(rounded.vertices[moved] - mesh.vertices[moved], axis=1)
    message = f"{len(moved)} vertices were rounded to single precision, by {distances.max():.2g} mm at most"
    return rounded, [Change("rounding", message, mesh.vertices[moved], distances)]


def _is_fit(mesh: Mesh, inputs: HealParameters) -> bool:
    """True if nothing is to be done."""
    return (
        not inputs.staircase
        and not find_faults(mesh)
        and not find_unwanted(mesh.vertices, mesh.faces, inputs.pieces, inputs.min_piece_share)[0].any()
    )


def _require_fit(mesh: Mesh) -> None:
    faults = find_faults(mesh)
    if faults:
        raise InputError(
            "heal.not_resolved",
            f"faults are left that could not be mended within the limits: {faults[0].message}",
            findings=faults,
            count=faults[0].count,
        )
