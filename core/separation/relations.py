"""Who holds whom, and who lies beside whom: declared, or found by where most of a surface lies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations, permutations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas
from core.mesh import Mesh
from core.separation.contacts import COINCIDENT_MM, find_contacts
from core.separation.sides import are_faces_inside

Relation = Literal["inside", "around", "beside"]
Floats = NDArray[np.float64]

CLEAR_SHARE = 0.75  # of a surface's area: from here on it counts as inside, below the rest to 1 as outside


@dataclass(frozen=True, slots=True)
class Share:
    """How much of one surface lies inside another: of its area, and of the piece with least and most of it."""

    whole: float
    least: float
    most: float


NOWHERE = Share(0.0, 0.0, 0.0)  # of a surface that lies on another one with all its faces


def find_relations(meshes: Mapping[str, Mesh], inside: Mapping[str, str | None]) -> dict[tuple[str, str], Relation]:
    """(a, b) -> what a is to b, for every ordered pair.

    inside: surface -> the one that holds it most closely, or None; who is missing is found.
    Needs:    closed surfaces.
    Raises:   InputError `separate.identical`, `separate.unclear_sides`, `separate.not_inside`, `separate.partly_inside`,
              `separate.unordered`.
    """
    holders = {name: _holders(name, inside) for name in inside}
    trees = {name: FaceTree.of(mesh.vertices, mesh.faces) for name, mesh in meshes.items()}
    relations: dict[tuple[str, str], Relation] = {}
    for a, b in combinations(meshes, 2):
        relation = _relation(a, b, meshes, trees, holders)
        relations[a, b] = relation
        relations[b, a] = {"inside": "around", "around": "inside", "beside": "beside"}[relation]  # type: ignore[assignment]
    _require_order(relations, list(meshes))
    return relations


def _holders(name: str, inside: Mapping[str, str | None]) -> list[str]:
    """All declared to hold a surface, closest first."""
    found: list[str] = []
    holder = inside.get(name)
    while holder is not None:
        if holder == name or holder in found:
            words = " inside ".join((name, *found, holder))
            raise InputError("separate.unordered", f"nothing can be inside itself: {words}", tissue=name)
        found.append(holder)
        holder = inside.get(holder)
    return found


def _relation(
    a: str, b: str, meshes: Mapping[str, Mesh], trees: Mapping[str, FaceTree], holders: Mapping[str, list[str]]
) -> Relation:
    share_a, share_b = _shares(a, b, meshes, trees)
    if b in holders.get(a, ()):
        _require_inside(a, b, share_a)
        return "inside"
    if a in holders.get(b, ()):
        _require_inside(b, a, share_b)
        return "around"
    if a in holders and b in holders:
        return "beside"
    low, high = 1.0 - CLEAR_SHARE, CLEAR_SHARE
    if share_a.whole >= high and share_b.whole <= low:
        _require_whole(a, b, share_a)
        return "inside"
    if share_b.whole >= high and share_a.whole <= low:
        _require_whole(b, a, share_b)
        return "around"
    if share_a.whole <= low and share_b.whole <= low:
        _require_whole(a, b, share_a)
        _require_whole(b, a, share_b)
        return "beside"
    raise InputError(
        "separate.unclear_sides",
        f"{a} and {b} cross so far that neither is in the other nor beside it: {share_a.whole:.0%} of {a} lies inside {b}, "
        f"{share_b.whole:.0%} of {b} inside {a}; say which with `inside`",
        a=a,
        b=b,
        share_of_a=round(share_a.whole, 4),
        share_of_b=round(share_b.whole, 4),
    )


def _shares(a: str, b: str, meshes: Mapping[str, Mesh], trees: Mapping[str, FaceTree]) -> tuple[Share, Share]:
    """Of a inside b, of b inside a, by the middles of faces whose side can be told. Raises: InputError `separate.identical`."""
    coincident = find_contacts(trees[a], trees[b], COINCIDENT_MM)
    shares = []
    for name, other, contacts in ((a, b, coincident[0]), (b, a, coincident[1])):
        mesh = meshes[name]
        clear = np.ones(len(mesh.faces), dtype=np.bool_)
        middles = mesh.vertices[mesh.faces[contacts.faces]].mean(axis=1)
        clear[contacts.faces] = closest_points_in(trees[other], middles)[0] > COINCIDENT_MM
        shares.append(_share(mesh, clear, are_faces_inside(mesh.vertices, mesh.faces, trees[other], contacts.faces)))
    if shares[0] is None and shares[1] is None:
        raise InputError("separate.identical", f"{a} and {b} are the same surface: neither is inside the other", a=a, b=b)
    return shares[0] or NOWHERE, shares[1] or NOWHERE


def _share(mesh: Mesh, clear: NDArray[np.bool_], within: NDArray[np.bool_]) -> Share | None:
    """None if no face tells."""
    area = face_areas(mesh.vertices, mesh.faces) * clear
    count, piece = face_components(edges(mesh.faces))
    total = np.bincount(piece, weights=area, minlength=count)
    held = np.bincount(piece, weights=area * within, minlength=count)
    known = total > 0.0
    if not known.any():
        return None
    each = held[known] / total[known]
    return Share(float(held.sum() / total.sum()), float(each.min()), float(each.max()))


def _require_inside(inner: str, outer: str, share: Share) -> None:
    _require_whole(inner, outer, share)
    if share.whole < 0.5:
        raise InputError(
            "separate.not_inside",
            f"{inner} is said to lie inside {outer}, but {1.0 - share.whole:.0%} of it lies outside",
            inner=inner,
            outer=outer,
            share_outside=round(1.0 - share.whole, 4),
        )


def _require_whole(inner: str, outer: str, share: Share) -> None:
    """All pieces of a surface must lie on one side."""
    if share.least < 0.5 < share.most:
        raise InputError(
            "separate.partly_inside",
            f"some pieces of {inner} lie inside {outer}, others outside; take them apart into surfaces of their own",
            inner=inner,
            outer=outer,
        )


def _require_order(relations: Mapping[tuple[str, str], Relation], names: list[str]) -> None:
    """What is inside something is inside all that holds it, and two that hold the same are in each other."""
    for a, b, c in permutations(names, 3):
        in_both = relations[a, b] == "inside" and relations[a, c] == "inside"
        if in_both and relations[b, c] == "beside":
            raise InputError("separate.unordered", f"{a} lies inside both {b} and {c}, which lie beside each other", tissue=a)
        if relations[a, b] == "inside" and relations[b, c] == "inside" and relations[a, c] != "inside":
            raise InputError("separate.unordered", f"{a} lies inside {b} and that inside {c}, but {a} not inside {c}", tissue=a)
