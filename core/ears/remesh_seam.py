"""Good triangles along the seams that canals leave in a skin."""

from __future__ import annotations

from collections.abc import Sequence

from core.errors import InternalError
from core.geometry.cut_surface import CutSurface
from core.geometry.seams import RemeshedSurface, remesh_around_seams
from core.mesh import Mesh


def remesh_seams(cut: CutSurface, skin: Mesh, canals: Sequence[Mesh]) -> RemeshedSurface:
    """Split, collapse, flip and smooth around the seams.

    Needs:    what `cut_canals` made of skin and canals.
    Promises: as `remesh_around_seams`.
    Raises:   InternalError `canal.seam_not_proven` if no state of the seams passed the exact test.
    """
    remeshed = remesh_around_seams(cut, skin, canals)
    if remeshed is None:
        raise InternalError("canal.seam_not_proven", "the seam of a canal could not be made free of intersections")
    return remeshed
