"""All surfaces of a package as one list of vertices and faces, for formats that hold a model in one file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.package.region_tag import region_tags
from core.package.tissue import Tissue


@dataclass(frozen=True, eq=False, slots=True)
class MergedSurfaces:
    """vertices (V, 3) mm; faces (F, 3), numbers of vertices from 0; tags (F,), the volume number of the face's tissue."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    tags: NDArray[np.int64]


def merge(tissues: Sequence[Tissue]) -> MergedSurfaces:
    """Surfaces one after the other, in the order of tissues; no vertex is shared, since none touch."""
    starts = np.cumsum([0, *(len(tissue.mesh.vertices) for tissue in tissues)])
    tags = region_tags(tissues)
    return MergedSurfaces(
        np.vstack([tissue.mesh.vertices for tissue in tissues]),
        np.vstack([tissue.mesh.faces.astype(np.int64) + start for tissue, start in zip(tissues, starts, strict=False)]),
        np.repeat([tags[tissue.name] for tissue in tissues], [len(tissue.mesh.faces) for tissue in tissues]).astype(np.int64),
    )
