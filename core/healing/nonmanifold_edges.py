"""Edges with more than two faces: fins and inner walls go, bodies that share an edge are parted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Edges, edges
from core.geometry.components import label_connected
from core.geometry.normals import face_areas
from core.healing.change import Change, Staged
from core.healing.edge_pairing import part_edges
from core.healing.winding import winding_number
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

FIN_SHARE = 0.5  # of the area of all that hangs together: a loose sheet with less is a fin
FREE_SHARE = 0.2  # of a sheet's rim: if more has no other face it is loose; a wall with a slit is not
INSIDE_SCORE = 0.3  # what the body on both sides adds to the share of edges at which a sheet is the odd one out
WALL_SCORE = 0.5  # a sheet above it is an inner wall beyond doubt
WALLS_TRIED = 64  # sheets for which the winding number of the rest is computed; of more, the smallest area decides
ROUNDS = 64


def mend_nonmanifold_edges(vertices: Vertices, faces: Faces) -> Staged:
    """Leave at most two faces at every edge.

    Edges with more cut the surface into sheets. A small sheet with a border of its own is a fin, one with the body on
    both sides an inner wall: they go if that leaves no new border. What then still shares an edge is parted there.
    Neighbours within a sheet should look alike.
    """
    changes: list[Change] = []
    faces, taken = _without(vertices, faces, _find_fins)
    changes += _removal("fins", "sheets that stand on the surface were taken away", taken)
    faces, taken = _without(vertices, faces, _find_walls)
    changes += _removal("inner_walls", "sheets inside the body were taken away", taken)
    vertices, faces, parted = part_edges(vertices, faces)
    return vertices, faces, changes + parted


class Sheets:
    """The sheets into which edges with more than two faces cut the surface, and those edges."""

    def __init__(self, vertices: Vertices, faces: Faces, found: Edges) -> None:
        _edge, pair, _side = found.two_faces()
        self.count, self.of_face = label_connected(len(faces), pair[:, 0], pair[:, 1])
        crowded = found.face_count > 2
        row, side = np.nonzero(crowded[found.of_face])
        numbers, self.edge = np.unique(found.of_face[row, side], return_inverse=True)
        self.row, self.side = row, side
        self.sheet = self.of_face[row]  # of each face at a crowded edge
        self.face_count = found.face_count[numbers]
        self.area = np.bincount(self.of_face, weights=face_areas(vertices, faces), minlength=self.count)
        lengths = np.linalg.norm(vertices[found.ends[:, 0]] - vertices[found.ends[:, 1]], axis=1)[found.of_face]
        free, held = (
            np.bincount(self.of_face, weights=(lengths * where).sum(axis=1), minlength=self.count)
            for where in (found.face_count[found.of_face] == 1, found.face_count[found.of_face] > 2)
        )
        self.is_loose = free > FREE_SHARE * (free + held)
        _groups, self.group = label_connected(self.count + len(numbers), self.sheet, self.count + self.edge)
        self.group = self.group[: self.count]
        self.group_area = np.bincount(self.group, weights=self.area)

    def find_twice_at_an_edge(self) -> Ints:
        """Sheets with several faces at one crowded edge."""
        keys, times = np.unique(self.sheet * len(self.face_count) + self.edge, return_counts=True)
        return np.unique(keys[times > 1] // len(self.face_count))

    def odd_shares(self, vertices: Vertices, faces: Faces) -> Floats:
        """Share of each sheet's crowded edges, by length, at which the other two faces are the flattest pair of the three."""
        row, side, edge = self.row, self.side, self.edge
        at_three = np.flatnonzero(self.face_count[edge] == 3)
        three = at_three[np.argsort(edge[at_three], kind="stable")].reshape(-1, 3)
        start, end, tip = (vertices[faces[row[three], (side[three] + turn) % 3]] for turn in range(3))
        along = end[:, 0] - start[:, 0]
        length = np.linalg.norm(along, axis=1)
        arms = tip - start[:, :1]
        arms -= np.einsum("nij,nj->ni", arms, along / length[:, None])[..., None] * (along / length[:, None])[:, None]
        arms /= np.maximum(np.linalg.norm(arms, axis=2), 1e-300)[..., None]
        # a flat pair has its arms on opposite sides of the edge
        facing = np.stack([np.einsum("nj,nj->n", arms[:, (i + 1) % 3], arms[:, (i + 2) % 3]) for i in range(3)], axis=1)
        odd = np.argmin(facing, axis=1)
        votes = np.bincount(self.sheet[three[np.arange(len(three)), odd]], weights=length, minlength=self.count)
        total = np.bincount(self.sheet[three].ravel(), weights=np.repeat(length, 3), minlength=self.count)
        shares: Floats = votes / np.maximum(total, 1e-300)
        return shares

    def choose(self, order: Ints, leaves: tuple[int, ...] | None) -> Ints:
        """As many of the sheets, in this order, as may go at once: with none of their crowded edges is done twice.

        leaves: how many faces may be left at these edges; None: two or more.
        """
        by_sheet = np.argsort(self.sheet, kind="stable")
        starts = np.searchsorted(self.sheet[by_sheet], np.arange(self.count + 1))
        used = np.zeros(len(self.face_count), dtype=np.bool_)
        chosen = []
        for sheet in order.tolist():
            at, times = np.unique(self.edge[by_sheet[starts[sheet] : starts[sheet + 1]]], return_counts=True)
            left = self.face_count[at] - times
            fits = (left >= 2).all() if leaves is None else np.isin(left, leaves).all()
            if fits and len(at) and not used[at].any():
                used[at] = True
                chosen.append(sheet)
        return np.array(chosen, dtype=np.int64)


Find = Callable[[Vertices, Faces, Sheets], Ints]


def _find_fins(vertices: Vertices, faces: Faces, sheets: Sheets) -> Ints:
    """Small sheets much of whose rim is free."""
    small = sheets.area < FIN_SHARE * sheets.group_area[sheets.group]
    fins = np.intersect1d(np.flatnonzero(sheets.is_loose & small), sheets.sheet)
    return sheets.choose(fins[np.argsort(sheets.area[fins], kind="stable")], None)


def _find_walls(vertices: Vertices, faces: Faces, sheets: Sheets) -> Ints:
    """Sheets after whose removal all edges have two faces, first those that stand out from the rest, and with the body around."""
    candidates = np.unique(sheets.sheet)
    candidates = candidates[np.argsort(sheets.area[candidates], kind="stable")]
    # a sheet that has both its sides at an edge is closed there: a body, which only shares the edge
    single = np.setdiff1d(candidates, sheets.find_twice_at_an_edge(), assume_unique=True)
    candidates = candidates[np.isin(candidates, single)]
    fitting = np.array([sheet for sheet in candidates if len(sheets.choose(np.array([sheet]), (2,)))], dtype=np.int64)
    if len(fitting) == 0:
        return fitting
    inside = np.array([_is_inside(vertices, faces, sheets, int(sheet)) for sheet in fitting[:WALLS_TRIED]])
    fitting = fitting[:WALLS_TRIED]
    score = sheets.odd_shares(vertices, faces)[fitting] + INSIDE_SCORE * inside
    order = fitting[np.argsort(-score, kind="stable")]
    # where nothing tells, one goes and the others are judged anew without it
    return sheets.choose(order[: max(1, int((score > WALL_SCORE).sum()))], (2,))


def _is_inside(vertices: Vertices, faces: Faces, sheets: Sheets, sheet: int) -> bool:
    """True if the rest of what hangs together winds around the sheet."""
    own = sheets.of_face == sheet
    rest = faces[(sheets.group[sheets.of_face] == sheets.group[sheet]) & ~own]
    largest = np.flatnonzero(own)[np.argmax(face_areas(vertices, faces[own]))]
    return abs(winding_number(vertices, rest, vertices[faces[largest]].mean(axis=0))) > 0.5


def _without(vertices: Vertices, faces: Faces, find: Find) -> tuple[Faces, list[Floats]]:
    """Take sheets away until none is found; the faces that are left and the triangles of each sheet."""
    taken: list[Floats] = []
    for _ in range(ROUNDS):
        found = edges(faces)
        if not (found.face_count > 2).any():
            break
        sheets = Sheets(vertices, faces, found)
        chosen = find(vertices, faces, sheets)
        if len(chosen) == 0:
            break
        taken += [vertices[faces[sheets.of_face == sheet]] for sheet in chosen]
        faces = faces[~np.isin(sheets.of_face, chosen)]
    return faces, taken


def _removal(kind: str, what: str, taken: list[Floats]) -> list[Change]:
    if not taken:
        return []
    points = np.array([triangles.mean(axis=(0, 1)) for triangles in taken])
    triangles = np.concatenate(taken)
    message = f"{len(taken)} {what}, {len(triangles)} faces"
    return [Change(kind, message, points, np.zeros(len(points)), taken=triangles)]
