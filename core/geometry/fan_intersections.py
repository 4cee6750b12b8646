"""Exact intersections of faces that run in thousands into one corner, without comparing each with each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.coincidence import group_equal_faces
from core.geometry.degenerate import find_degenerate_faces
from core.geometry.fans import MANY_FACES, find_pairs_in_fan
from core.geometry.meeting_faces import do_meet
from core.geometry.near_pairs import NONE, Faces, Triangles, find_near_pairs
from core.mesh import Faces as FaceRows
from core.mesh import Vertices

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

AT_ONCE = 1 << 17  # pairs decided together


def find_fan_faces(places: Ints) -> Flags:
    """Faces (F,) with a corner where more than `MANY_FACES` meet; places (F, 3): `position_ids` of the corners."""
    hubs = _hubs(places)
    return hubs[places[:, 0]] | hubs[places[:, 1]] | hubs[places[:, 2]]


def find_intersections_of_fans(vertices: Vertices, faces: FaceRows, places: Ints, in_fan: Flags) -> Ints:
    """Pairs (K, 2) with a face in a fan that meet as `find_intersecting_faces` has it; sorted. Equal faces are left out.

    Faces without a hub in common are looked for in space, those around a hub by their directions from there: O(F log F)
    where needles do not cross.
    """
    solid = np.ones(len(faces), dtype=np.bool_)
    solid[find_degenerate_faces(vertices, faces)] = False
    first_alike = group_equal_faces(places)
    solid &= first_alike == np.arange(len(faces))  # one of equal faces stands for all
    everything = Faces(vertices[faces], places)
    is_hub = _hubs(places)
    rows = np.flatnonzero(solid)
    hub = np.where(is_hub[places[rows]], places[rows], NONE)
    parts = [find_near_pairs(Triangles(everything.corners[rows], rows, hub, in_fan[rows]), everything)]
    member, corner = np.nonzero(hub != NONE)
    order = np.argsort(hub[member, corner], kind="stable")
    of_hub, member = hub[member, corner][order], rows[member[order]]
    starts = np.flatnonzero(np.diff(of_hub, prepend=-1))
    parts += [
        find_pairs_in_fan(everything, int(of_hub[first]), members)
        for first, members in zip(starts, np.split(member, starts[1:]), strict=True)
    ]
    near = np.unique(np.concatenate(parts), axis=0)
    meet = [do_meet(everything.corners, places, near[start : start + AT_ONCE]) for start in range(0, len(near), AT_ONCE)]
    return _with_equals(near[np.concatenate(meet)], first_alike) if meet else near


def _with_equals(pairs: Ints, first_alike: Ints) -> Ints:
    """The pairs (K, 2) of faces that stand for all equal ones, and those of all they stand for; sorted."""
    order = np.argsort(first_alike, kind="stable")
    start = np.searchsorted(first_alike[order], pairs)
    size = np.searchsorted(first_alike[order], pairs, side="right") - start
    count = size.prod(axis=1)
    row = np.repeat(np.arange(len(pairs)), count)
    step = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    of_second = size[row, 1]
    both = np.column_stack((order[start[row, 0] + step // of_second], order[start[row, 1] + step % of_second]))
    return np.unique(np.sort(both, axis=1), axis=0)


def _hubs(places: Ints) -> Flags:
    """For each place whether more than `MANY_FACES` corners are there."""
    hubs: Flags = np.bincount(places.ravel(), minlength=1) > MANY_FACES
    return hubs
