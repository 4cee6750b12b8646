"""Which rim of the base belongs to which rim of the donor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.errors import InputError
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.grafting.piece import Piece
from core.grafting.refusal import place_finding, words
from core.grafting.transition import nearest_distance
from core.schema.counted import counted

Floats = NDArray[np.float64]
Pieces = tuple[Piece, Piece]
Pairs = list[tuple[int, int]]

TURNS = 64  # rims that only graze the wall and are filled or dropped, at most


def match_rims(pieces: Pieces, depth_mm: float) -> tuple[Pieces, Pairs]:
    """Pair every rim of base and donor, after those were filled or dropped that reach no deeper than `depth_mm` past the wall.

    Raises: InputError `graft.loops_do_not_match` with the middles of the rims that are left alone.
    """
    turned: Pieces | None = pieces
    for _ in range(TURNS):
        if turned is None:
            break
        pairs, alone = _pair_pieces(turned)
        if pairs and not any(alone):
            return turned, pairs
        turned = _turn_one(turned, alone, depth_mm)
    pairs, alone = _pair_pieces(pieces)
    counts = [len(piece.rims) for piece in pieces]
    message = (
        f"the walls of the region cut the base along {counted(counts[0], 'line')} and the donor along {counts[1]}, "
        f"of which {len(pairs)} belong together; move the box to where its walls pass both surfaces alike"
    )
    findings = tuple(
        place_finding(
            "graft.loops_do_not_match",
            piece.name,
            [piece.mesh.vertices[piece.rims[rim]].mean(axis=0) for rim in rims],
            f"{counted(len(rims), 'line')} of the {piece.name} at the walls have no counterpart",
        )
        for piece, rims in zip(pieces, alone, strict=True)
        if rims
    )
    raise InputError(
        "graft.loops_do_not_match", message, findings=findings, base_rims=counts[0], donor_rims=counts[1], pairs=len(pairs)
    )


def pair_rims(base: Sequence[Floats], donor: Sequence[Floats]) -> Pairs:
    """Pairs (base rim, donor rim) that are each other's nearest; rims are (N, 3) mm.

    Near is measured by the mean distance from the points of either rim to the other, the larger of the two.
    """
    if not base or not donor:
        return []
    trees = [cKDTree(rim) for rim in base], [cKDTree(rim) for rim in donor]
    apart = np.array(
        [
            [
                max(nearest_distance(trees[0][i], there).mean(), nearest_distance(trees[1][j], here).mean())
                for j, there in enumerate(donor)
            ]
            for i, here in enumerate(base)
        ]
    )
    nearest_donor, nearest_base = apart.argmin(axis=1), apart.argmin(axis=0)
    return [(i, int(j)) for i, j in enumerate(nearest_donor) if nearest_base[j] == i]


def require_near(pieces: Pieces, trees: tuple[FaceTree, FaceTree], max_distance_mm: float) -> float:
    """Largest distance in mm from the rims of each mesh to the whole surface of the other (trees: base, donor).

    Raises: InputError `graft.too_far` with the rim vertices that are farther than `max_distance_mm`, farthest first.
    """
    largest = 0.0
    for piece, other, tree in ((pieces[0], pieces[1], trees[1]), (pieces[1], pieces[0], trees[0])):
        points = np.concatenate(piece.rim_points())
        distance = closest_points_in(tree, points)[0]
        far = np.flatnonzero(distance > max_distance_mm)
        if len(far):
            worst = far[np.argsort(-distance[far], kind="stable")]
            message = (
                f"at the seam the {piece.name} is up to {distance[worst[0]]:.3g} mm from the {other.name}, "
                f"at {words(points[worst[0]])} mm; at most {max_distance_mm:g} mm are bridged"
            )
            raise InputError(
                "graft.too_far",
                message,
                findings=(place_finding("graft.too_far", piece.name, points[worst], message),),
                distance_mm=float(distance[worst[0]]),
                max_distance_mm=max_distance_mm,
                count=len(far),
            )
        largest = max(largest, float(distance.max()))
    return largest


def _pair_pieces(pieces: Pieces) -> tuple[Pairs, list[list[int]]]:
    """Pairs of rims, and the rims of each piece that are in none."""
    pairs = pair_rims(pieces[0].rim_points(), pieces[1].rim_points())
    alone = [sorted(set(range(len(piece.rims))) - {pair[side] for pair in pairs}) for side, piece in enumerate(pieces)]
    return pairs, alone


def _turn_one(pieces: Pieces, alone: list[list[int]], depth_mm: float) -> Pieces | None:
    """The pieces with one lonely rim less, the shortest that can be turned first and is not the last; None if there is none."""
    for side, rims in enumerate(alone):
        for rim in sorted(rims, key=lambda number: len(pieces[side].rims[number])):
            turned = pieces[side].with_turned(pieces[side].rims[rim], depth_mm)
            if turned is not None and turned.rims:
                return (turned, pieces[1]) if side == 0 else (pieces[0], turned)
    return None
