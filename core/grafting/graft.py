"""Set a region of one surface into another (thesis 6.4.1 to 6.4.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from core.errors import InputError
from core.geometry.face_tree import FaceTree
from core.grafting.bisect import bisect_at_wall
from core.grafting.crossing import find_misfits, widen
from core.grafting.joining import Seam, join
from core.grafting.pairing import match_rims, require_near
from core.grafting.piece import Piece
from core.grafting.refusal import place_finding, require_region
from core.grafting.wall import Box
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.counted import counted

EDGE_SHARE = 0.6  # of the seam's width: longest edges along the walls
ATTEMPTS = 12  # each widens the seam where it did not fit


@dataclass(frozen=True, eq=False, slots=True)
class Graft:
    """What was made of what.

    mesh: faces of the base first, then the donor's, then the bands'. bisected: faces more than before in base and donor, by
    halving edges at the walls. apart_mm: largest distance between the two surfaces at the seams.
    """

    mesh: Mesh
    base_faces: int
    donor_faces: int
    band_faces: int
    base_removed: int
    bisected: tuple[int, int]
    seams: tuple[Seam, ...]
    apart_mm: float
    attempts: int


def graft(
    base: Mesh, donor: Mesh, boxes: Sequence[Box], *, seam_mm: float, max_distance_mm: float, run: RunContext = SILENT
) -> Graft:
    """Take what lies in the boxes out of the base, put the donor's in, and join the rims by bands of new triangles.

    Needs:    base and donor closed, manifold, outward and free of self-intersection; coordinates as float32 holds them.
    Promises: no face of donor or band intersects another, exactly; vertices of base and donor outside of the bands keep
              their places bit for bit; base and donor stay the surfaces they are outside of the bands; same input, same result.
    Raises:   InputError `region.outside_mesh`, `region.covers_mesh`, `graft.loops_do_not_match`, `graft.too_far`,
              `graft.seam_crosses`; LimitError `graft.seam_too_fine`.
    Source:   thesis 6.4.1 to 6.4.3. There one surface was drawn anew through all points; here only the gap is triangulated."""
    margin_mm = seam_mm / 2
    run.advance(0.0, f"faces along the walls are made finer than {seam_mm * EDGE_SHARE:.3g} mm")
    base_piece = _cut("base", base, boxes, margin_mm)
    donor_piece = _cut("donor", donor, boxes, margin_mm)
    bisected = len(base_piece.mesh.faces) - len(base.faces), len(donor_piece.mesh.faces) - len(donor.faces)
    pieces = base_piece, donor_piece
    trees = FaceTree.of(base.vertices, base.faces), FaceTree.of(donor.vertices, donor.faces)
    for attempt in range(1, ATTEMPTS + 1):
        try:
            pieces, pairs = match_rims(pieces, margin_mm + max_distance_mm)
            apart_mm = require_near(pieces, trees, max_distance_mm)
        except InputError:
            if attempt == 1:
                raise
            break  # what is left after widening cannot be joined: what crossed before is the reason to tell
        joined, seams = join(pieces, pairs, trees, max_distance_mm)
        kept, put_in = (int(piece.taken.sum()) for piece in pieces)
        misfits = find_misfits(joined, kept, put_in)
        run.advance(attempt / ATTEMPTS, f"attempt {attempt}: {counted(len(seams), 'seam')}, {len(misfits)} faces do not fit")
        if len(misfits) == 0:
            removed = len(base_piece.mesh.faces) - kept
            band = len(joined.faces) - kept - put_in
            return Graft(joined, kept, put_in, band, removed, bisected, seams, apart_mm, attempt)
        pieces = widen(pieces, joined, misfits)
    message = (
        f"the seam runs through the surface or folds onto it at {len(misfits)} faces, and widening it does not help; "
        "move the box to where base and donor run side by side, or use another seam width"
    )
    places = joined.triangles()[misfits].mean(axis=1)
    raise InputError(
        "graft.seam_crosses",
        message,
        findings=(place_finding("graft.seam_crosses", "base", places, message),),
        count=len(misfits),
    )


def _cut(name: str, mesh: Mesh, boxes: Sequence[Box], margin_mm: float) -> Piece:
    """The base outside of the boxes, or the donor inside, off the walls by the margin."""
    fine = bisect_at_wall(mesh, boxes, margin_mm=margin_mm, edge_mm=2 * margin_mm * EDGE_SHARE)
    require_region(name, fine, boxes)
    return Piece.cut(name, fine, boxes, inside=name == "donor", margin_mm=margin_mm)
