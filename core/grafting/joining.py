"""Two pieces and the bands between their rims as one mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import LimitError
from core.geometry.face_tree import FaceTree
from core.grafting.band import triangulate_band
from core.grafting.pairing import Pairs, Pieces
from core.grafting.refine import refine_band
from core.grafting.transition import Transition
from core.mesh import Faces, Mesh
from core.validation.places import point_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LONGEST_RIM = 5000  # vertices; the band's path is found in a table of one rim by the other


@dataclass(frozen=True, eq=False, slots=True)
class Seam:
    """One band: its faces, the vertices of its rims, and the longest way from rim to rim, with the middle of it."""

    faces: int
    base_rim: int
    donor_rim: int
    widest_mm: float
    point_mm: tuple[float, float, float]


def join(pieces: Pieces, pairs: Pairs, trees: tuple[FaceTree, FaceTree], reach_mm: float) -> tuple[Mesh, tuple[Seam, ...]]:
    """The taken faces of base and donor, then a band for each pair of rims; vertices without faces are left out.

    trees: the whole surfaces of base and donor, which the bands follow where these are within `reach_mm`.
    Raises: LimitError `graft.seam_too_fine`.
    """
    base, donor = pieces
    shift = len(base.mesh.vertices)
    vertices = [base.mesh.vertices, donor.mesh.vertices]
    kept = base.mesh.faces[base.taken].astype(np.int64), donor.mesh.faces[donor.taken].astype(np.int64) + shift
    faces, seams = list(kept), []
    count = shift + len(donor.mesh.vertices)
    for base_rim, donor_rim in pairs:
        outer, inner = base.rims[base_rim], donor.rims[donor_rim][::-1]  # the donor's rim runs the other way round
        if max(len(outer), len(inner)) > LONGEST_RIM:
            raise LimitError(
                "graft.seam_too_fine",
                f"a rim has {max(len(outer), len(inner))} vertices, at most {LONGEST_RIM} can be joined; use a wider seam",
                vertices=max(len(outer), len(inner)),
                limit=LONGEST_RIM,
            )
        rims = base.mesh.vertices[outer], donor.mesh.vertices[inner]
        points, number = np.concatenate(rims), np.concatenate((outer, inner + shift))
        band = triangulate_band(*rims)
        widest_mm, place = _widest(points, band, len(outer))
        present = _edges_between(number, kept, count=shift + len(donor.mesh.vertices))
        points, band = refine_band(points, band, present, Transition(*trees, *rims, reach_mm).draw)
        new = points[len(number) :].astype(np.float32).astype(np.float64)
        seams.append(Seam(len(band), len(outer), len(inner), widest_mm, place))
        faces.append(np.concatenate((number, count + np.arange(len(new))))[band])
        vertices.append(new)
        count += len(new)
    used, renumbered = np.unique(np.concatenate(faces), return_inverse=True)
    return Mesh.of(np.concatenate(vertices)[used], renumbered.reshape(-1, 3)), tuple(seams)


def _edges_between(rim: Ints, kept: tuple[Ints, Ints], count: int) -> Ints:
    """Edges of the kept faces whose two ends are vertices of the rim (N,), as places in it: (L, 2)."""
    place = np.full(count, -1, dtype=np.int64)
    place[rim] = np.arange(len(rim))
    corners = np.concatenate([place[faces] for faces in kept])
    sides = np.concatenate((corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]))
    return sides[(sides >= 0).all(axis=1)]


def _widest(points: Floats, band: Faces, outer_count: int) -> tuple[float, tuple[float, float, float]]:
    """Length and middle of the longest edge of the band from rim to rim."""
    sides = np.concatenate((band[:, [0, 1]], band[:, [1, 2]], band[:, [2, 0]]))
    across = sides[(sides < outer_count).sum(axis=1) == 1]
    lengths = np.linalg.norm(points[across[:, 0]] - points[across[:, 1]], axis=1)
    longest = int(np.argmax(lengths))
    return float(lengths[longest]), point_of(points[across[longest]].mean(axis=0))
