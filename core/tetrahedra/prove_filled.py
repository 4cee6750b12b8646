"""Whether tetrahedra fill what lies between surfaces, wholly and no more."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from core.errors import InternalError
from core.geometry.volume import signed_volumes
from core.mesh import Mesh
from core.tetrahedra.element_quality import volumes
from core.tetrahedra.sides import NONE, face_keys, sides
from core.tetrahedra.volume_mesh import VolumeMesh

VOLUME_TOLERANCE = 1e-9  # of the whole; sums of a million terms in double precision keep more
NOBODY = -1  # the region outside of all tissues


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
    all_sides = sides(volume.tetrahedra)
    first = volume.region[all_sides.first]
    second = np.where(all_sides.second == NONE, NOBODY, volume.region[all_sides.second])
    at_border = first != second
    first, second, keys = first[at_border], second[at_border], face_keys(all_sides.corners[at_border])
    names = list(surfaces)
    faults = []
    start = total = 0
    for number, (name, mesh) in enumerate(surfaces.items()):
        around = NOBODY if (enclosing := nesting[name]) is None else names.index(enclosing)
        wanted = face_keys(np.sort(mesh.faces.astype(np.int64) + start, axis=1))
        between = ((first == number) & (second == around)) | ((first == around) & (second == number))
        missing = int((~np.isin(wanted, keys[between])).sum())
        if missing:
            faults.append(f"{missing} faces of '{name}' are no border between it and what is around it")
        start += len(mesh.vertices)
        total += len(wanted)
    if len(keys) != total:
        faults.append(f"tissues border at {len(keys)} faces, the surfaces have {total}")
    return faults
