"""All surfaces in one GLB: tissues in their colours, what encloses others seen through."""

from __future__ import annotations

from collections.abc import Sequence

from core.io.glb import GlbPart, glb_bytes
from core.package.tissue import Tissue
from core.reports.palette import tissue_colours

FILE = "glb/surfaces.glb"
VEIL = 0.35  # opacity of what has something inside


def surfaces_glb(tissues: Sequence[Tissue]) -> bytes:
    """A node per tissue. Viewers draw what can be seen through in the order of the file, so the innermost come first."""
    colours = tissue_colours([tissue.name for tissue in tissues])
    holders = {tissue.enclosing for tissue in tissues}
    return glb_bytes(
        [
            GlbPart(tissue.name, tissue.mesh, colours[tissue.name], VEIL if tissue.name in holders else 1.0)
            for tissue in reversed(tissues)
        ]
    )
