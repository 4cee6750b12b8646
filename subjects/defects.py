"""The healing corpus: surfaces with known defects, each with the healthy one it was made from.

A right result is free of errors, has as many pieces and handles as the healthy surface, and lies within `bound_mm` of it,
measured both ways. The bounds say what can be known: nothing may move where nothing is missing; a crack may close anywhere
within its width; a patch over a hole may be off by two fifths of how far it reaches in; a fold by what it was made of.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from types import MappingProxyType
from typing import Any

import numpy as np
from igl.copyleft.cgal import mesh_boolean

from core.geometry.deviation import measure_deviation
from core.mesh import Mesh
from subjects.corpus import ARMS_DOWN
from subjects.damage.healthy import BALL, BODY, CUBE, HAND, HEAD, Healthy
from subjects.damage.joints import twin_across_edge
from subjects.damage.kinds import KINDS, TIGHT_MM, Kind
from subjects.damage.overlaps import balls_at, united
from subjects.damage.steps import stepped
from subjects.generated import voxels
from subjects.generated.pieces import moved, together
from subjects.generated.revolved import star_shape
from subjects.people import person

SEAM_MM = 0.3  # new triangles along the line where pieces were united


@dataclass(frozen=True)
class Defective:
    """One entry. options: what `heal` is asked for beside its defaults. quick: part of the normal tests."""

    name: str
    classes: tuple[str, ...]
    make: Callable[[], Mesh]
    healthy: Callable[[], Mesh]
    fixed_mm: float
    share: float = 0.0
    options: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    quick: bool = False

    @property
    def bound_mm(self) -> float:
        """How far a healed surface may lie off the healthy one."""
        if self.share == 0.0:
            return self.fixed_mm
        return self.fixed_mm + self.share * measure_deviation(self.healthy(), self.make()).forth.maximum_mm


KIND = {kind.name: kind for kind in KINDS}


def _damaged(on: Healthy, kinds: tuple[Kind, ...], name: str) -> Mesh:
    mesh = on.mesh()
    for kind in kinds:
        mesh = kind.applied(mesh, on, name)
    return mesh


def _entry(on: Healthy, *kinds: Kind, quick: bool = False) -> Defective:
    name = f"{on.name}, {' + '.join(kind.name for kind in kinds)}"
    classes = tuple(dict.fromkeys(kind.of for kind in kinds))
    fixed = sum(kind.bound(on.edge_mm) for kind in kinds)
    share = max(kind.share for kind in kinds)
    return Defective(name, classes, partial(_damaged, on, kinds, name), on.mesh, fixed, share, quick=quick)


SINGLE = tuple(_entry(on, kind, quick=on.name == kind.quick_on) for kind in KINDS for on in kind.subjects)
MIXED: tuple[tuple[Healthy, tuple[str, ...]], ...] = (
    (BODY, ("faces missing", "triangle soup")),
    (BODY, ("cracks of 0.05 mm", "a tenth of faces flipped")),
    (BODY, ("fins", "crumbs inside", "holes of two rings")),
    (BODY, ("naive offset by 2 mm", "many holes")),
    (BODY, ("ear-sized hole", "scraps outside", "doubled faces")),
    (BODY, ("ear-sized hole", "naive offset of toes by 2 mm")),
    (BODY, ("T-junctions", "unwelded patches", "inside out")),
    (BODY, ("vertices folded over", "crumbs outside", "triangle soup")),
    (HEAD, ("naive offset by 2 mm", "ear-sized hole", "triangle soup")),
    (HEAD, ("flap", "faces missing")),
    (HEAD, ("inner wall", "cracks of 0.05 mm")),
    (HEAD, ("crumpled patch", "holes of two rings", "a tenth of faces flipped")),
    (HEAD, ("sheet inside", "scraps outside", "inside out")),
    (HEAD, ("flat caps", "doubled faces, turned", "unwelded patches")),
    (HEAD, ("cracks of 0.5 mm", "many holes")),
    (HEAD, ("naive offset by 3 mm", "T-junctions")),
    (HAND, ("pinch", "holes of two rings")),
    (HAND, ("vertices folded over", "a tenth of faces flipped")),
    (HAND, ("fins", "T-junctions", "crumbs outside")),
    (HAND, ("needles of 1 µm", "triangle soup")),
    (HAND, ("faces missing", "cracks of 0.05 mm", "inside out")),
    (HAND, ("naive offset by 3 mm", "unwelded patches")),
    (HAND, ("hole across a crease", "doubled faces")),
    (BALL, ("faces missing", "flat caps", "triangle soup")),
    (BALL, ("hole with an islet", "crumbs inside")),
    (BALL, ("inner wall", "a tenth of faces flipped")),
    (BALL, ("vertices folded over", "many holes", "triangle soup")),
    (BALL, ("pinch", "fins")),
    (BALL, ("crumpled patch", "cracks of 0.05 mm")),
    (BALL, ("bodies sharing an edge", "scraps outside", "inside out")),
)
QUICK_MIXED = (3, 13, 18, 23)
COMBINED = tuple(
    _entry(on, *(KIND[name] for name in names), quick=number in QUICK_MIXED) for number, (on, names) in enumerate(MIXED)
)


def _pieces(name: str, make: Callable[[], tuple[Mesh, ...]], *, quick: bool = False) -> Defective:
    return Defective(name, ("overlap",), lambda: together(*make()), lambda: united(*make()), SEAM_MM, quick=quick)


@lru_cache(maxsize=1)
def _arms_in_hips() -> Mesh:
    """The union of a body with itself, by exact arithmetic; the far tetrahedron, taken off again, is what the call wants."""
    mesh = person(turns=ARMS_DOWN)
    far = 1e5 + np.vstack((np.zeros(3), np.eye(3)))
    corners = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    vertices, faces, birth = mesh_boolean(mesh.vertices, mesh.faces.astype(np.int64), far, corners, "union")
    return Mesh.of(vertices, faces[birth < len(mesh.faces)])


def _egg() -> Mesh:
    """The egg of `staircase_ellipsoid`, smooth."""
    tilt = np.array([[0.8, -0.6, 0.0], [0.48, 0.64, -0.6], [0.36, 0.48, 0.8]])
    return star_shape(lambda u: 1.0 / np.linalg.norm(u @ tilt.T / (45.0, 30.0, 20.0), axis=1), 5)


ALL_PIECES: Mapping[str, Any] = MappingProxyType({"pieces": "keep_all"})
SMOOTH_STEPS: Mapping[str, Any] = MappingProxyType({"staircase": True, "staircase_max_mm": 1.5})
OVERLAPPING = (
    _pieces("two balls", lambda: balls_at([(0, 0, 0), (17.3, 3.1, 1.7)], 15), quick=True),
    _pieces("three balls in a row", lambda: balls_at([(0, 0, 0), (17.3, 3.1, 1.7), (33.1, -2.3, 5.9)], 12)),
    _pieces("five balls around one", lambda: balls_at([(0, 0, 0), (14, 1, 0), (-13, 2, 1), (1, 14, 2), (0, -13, 3)], 10)),
    _pieces("balls that barely touch", lambda: balls_at([(0, 0, 0), (29.5, 1.1, 0.7)], 15)),
    _pieces("ball and cube", lambda: (CUBE.mesh(), *balls_at([(19.3, 18.1, 17.7)], 12))),
    _pieces("hump on the body", lambda: (BODY.mesh(), *balls_at([BODY.place("bald")], 30))),
    _pieces("lump on the head", lambda: (HEAD.mesh(), *balls_at([HEAD.place("bald")], 25)), quick=True),
    _pieces("ball stuck in the hand", lambda: (HAND.mesh(), *balls_at([HAND.place("bald")], 15))),
    _pieces("ball on a fingertip", lambda: (HAND.mesh(), *balls_at([HAND.place("flap")], 9))),
    _pieces("head in a ring of balls", lambda: (HEAD.mesh(), *balls_at([(80, 800, 60), (-80, 800, 60), (0, 700, 150)], 30))),
    _pieces("ball nearly swallowed", lambda: (BALL.mesh(), *balls_at([(18.7, 1.3, 2.1)], 12))),
    Defective("arms in the hips", ("overlap",), lambda: person(turns=ARMS_DOWN), _arms_in_hips, SEAM_MM),
)
STEPPED = (
    Defective("ball of voxels", ("staircase",), lambda: voxels.staircase_ball(30, 2.0), BALL.mesh, 1.5, options=SMOOTH_STEPS),
    Defective(
        "egg of voxels", ("staircase",), lambda: voxels.staircase_ellipsoid(45, 30, 20, 1.5), _egg, 1.2, options=SMOOTH_STEPS
    ),
    Defective("hand of voxels", ("staircase",), lambda: stepped(HAND.mesh(), 3.0), HAND.mesh, 4.5, options=SMOOTH_STEPS),
)
TWINS = (
    Defective(
        "two balls with one edge",
        ("edge_not_manifold",),
        lambda: twin_across_edge(BALL.mesh()),
        lambda: together(BALL.mesh(), moved(BALL.mesh(), 60.0, 0.0, 0.0)),
        TIGHT_MM,
        options=ALL_PIECES,
    ),
)
CORPUS = (*SINGLE, *COMBINED, *OVERLAPPING, *STEPPED)
