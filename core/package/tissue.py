"""One tissue of a package: a closed surface and what is inside it."""

from __future__ import annotations

from dataclasses import dataclass

from core.mesh import Mesh
from core.schema.shells import Side

FREE_SPACE = "FreeSpace"  # BEM-FMM's word for air


@dataclass(frozen=True, slots=True)
class Tissue:
    """The tissue between this surface and those of the tissues it encloses.

    mesh: outer surface in mm, every coordinate a float32 value. depth_mm: distance to the skin asked for outside all regions,
    None for the skin. conductivity_s_per_m: inside. enclosing: name of the tissue around it, or FREE_SPACE. side: of the skin,
    None for the skin.
    """

    name: str
    mesh: Mesh
    depth_mm: float | None
    conductivity_s_per_m: float
    enclosing: str
    side: Side | None = None
