"""Whether tetrahedra fill what lies between surfaces, wholly and no more."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.errors import InternalError
from core.geometry.volume import signed_volumes
from core.mesh import Mesh
from core.tetrahedra.element_quality import volumes
from core.tetrahedra.volume_mesh import VolumeMesh

VOLUME_TOLERANCE = 1e-9  # of the whole; sums of a million terms in double precision keep more
SIDES = np.array([(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)])


def prove_filled(volume: VolumeMesh, surfaces: Mapping[str, Mesh], nesting: Mapping[str, str | None]) -> None:
    """Raises: InternalError `tetrahedra.not_proven` if a tetrahedron is flat or inverted, a face of a surface is no face of
    tetrahedra or has not its tissue on its inner and the tissue around on its outer side, tetrahedra do not meet face to face,
    or the volumes of a tissue do not add up."""
    faults = [
        *_find_inverted(volume),
        *_find_wrong_volumes(volume, surfaces, nesting),
        *_find_wrong_sides(volume, surfaces, nesting),
    ]
    if faults:
        raise InternalError("tetrahedra.not_proven", f"the tetrahedra made do not pass the proof: {'; '.join(faults[:3])}")


def expected_volumes(surfaces: Mapping[str, Mesh], nesting: Mapping[str, str | None]) -> dict[str, float]:
    """Name -> mm³ between a surface and those directly inside it."""
    whole = {
        name: float(signed_volumes(mesh.vertices, mesh.faces, np.zeros(len(mesh.faces), dtype=np.int64))[0])
        for name, mesh in surfaces.items()
    }
    return {name: whole[name] - sum(whole[inner] for inner, around in nesting.items() if around == name) for name in surfaces}


def _find_inverted(volume: VolumeMesh) -> list[str]:
    flat = int((volumes(volume.corners()) <= 0).sum())
    return [f"{flat} tetrahedra are flat or inverted"] if flat else []


def _find_wrong_volumes(volume: VolumeMesh, surfaces: Mapping[str, Mesh], nesting: Mapping[str, str | None]) -> list[str]:
    wanted = expected_volumes(surfaces, nesting)
    found = np.bincount(volume.region, weights=volumes(volume.corners()), minlength=len(surfaces))
    tolerance = VOLUME_TOLERANCE * sum(abs(each) for each in wanted.values())
    return [
        f"'{name}' holds {measured:.9g} mm³ of tetrahedra instead of {wanted[name]:.9g}"
        for name, measured in zip(surfaces, found, strict=True)
        if abs(measured - wanted[name]) > tolerance
    ]


def _find_wrong_sides(volume: VolumeMesh, surfaces: Mapping[str, Mesh], nesting: Mapping[str, str | None]) -> list[str]:
    """Faces of tetrahedra with the same region on both sides are inner ones; what is left must be the surfaces."""
    first, second, corners = _find_borders(volume)
    names = list(surfaces)
    faults = []
    start = 0
    total = 0
    for number, (name, mesh) in enumerate(surfaces.items()):
        around = -1 if (enclosing := nesting[name]) is None else names.index(enclosing)
        wanted = np.sort(mesh.faces.astype(np.int64) + start, axis=1)
        between = ((first == number) & (second == around)) | ((first == around) & (second == number))
        missing = len(wanted) - int(np.isin(_keys(wanted), _keys(corners[between])).sum())
        if missing:
            faults.append(f"{missing} faces of '{name}' are no border between it and what is around it")
        start += len(mesh.vertices)
        total += len(wanted)
    if len(first) != total:
        faults.append(f"tissues border at {len(first)} faces, the surfaces have {total}")
    return faults


def _find_borders(volume: VolumeMesh) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Faces where regions meet: the two regions (N,), -1 for none, and the sorted corners (N, 3)."""
    corners = np.sort(volume.tetrahedra.astype(np.int64)[:, SIDES].reshape(-1, 3), axis=1)
    region = np.repeat(volume.region.astype(np.int64), len(SIDES))
    order = np.lexsort(corners.T[::-1])
    corners, region = corners[order], region[order]
    is_new = np.append(True, (corners[1:] != corners[:-1]).any(axis=1))
    starts = np.flatnonzero(is_new)
    count = np.diff(np.append(starts, len(corners)))
    if len(count) and count.max() > 2:
        raise InternalError("tetrahedra.not_proven", f"{int((count > 2).sum())} faces are shared by more than two tetrahedra")
    first = region[starts]
    second = np.where(count == 2, region[np.minimum(starts + 1, len(region) - 1)], -1)
    at_border = first != second
    return first[at_border], second[at_border], corners[starts][at_border]


def _keys(corners: NDArray[np.int64]) -> NDArray[np.void]:
    """Rows (N, 3) as single values that can be looked up."""
    return np.ascontiguousarray(corners).view([("", np.int64)] * 3).ravel()
