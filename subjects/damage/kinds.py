"""All single defects: what is done to which surface, and how near to the healthy one a healed one has to come."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from subjects.damage import dirt, faces, folds, holes, joints, seams
from subjects.damage.healthy import BALL, BODY, CUBE, HAND, HEAD, Healthy
from subjects.damage.places import Floats, Generator, extreme, nearest_vertex
from subjects.generated.pieces import inside_out

TIGHT_MM = 0.01
HOLE_SHARE = 0.4  # a flat lid over half a ball would be 0.7
CREASE_SHARE = 0.8  # a flat lid across a right angle is 0.7
TOES = (192.0, -802.0, 191.0)
ALL = (BODY, HEAD, HAND, BALL)
SMALL = (HEAD, HAND, BALL)


@dataclass(frozen=True)
class Kind:
    """A way to damage any healthy surface. damage takes the surface, a source of chance and its description.

    A healed one may lie off the healthy one by `bound` mm, given the median edge, and by `share` of the farthest that the
    healthy surface lies from the damaged one: that is how deep what is missing reaches away from what is left.
    """

    name: str
    of: str
    damage: Callable[[Mesh, Generator, Healthy], Mesh]
    bound: Callable[[float], float] = lambda _edge: TIGHT_MM
    share: float = 0.0
    subjects: tuple[Healthy, ...] = ALL
    quick_on: str = ""

    def applied(self, mesh: Mesh, on: Healthy, seed: str) -> Mesh:
        """The mesh with this defect; the same for the same words as seed."""
        return self.damage(mesh, np.random.default_rng(zlib.crc32(seed.encode())), on)


def _at(mesh: Mesh, place: tuple[float, float, float]) -> Floats:
    return mesh.vertices[nearest_vertex(mesh, np.array(place))]


def _middle(mesh: Mesh) -> Floats:
    middle: Floats = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    return middle


def _inside(mesh: Mesh, on: Healthy) -> Floats:
    """A point well inside, below the bald place."""
    return (
        _at(mesh, on.bald) - 4 * on.edge_mm * vertex_normals(mesh.vertices, mesh.faces)[nearest_vertex(mesh, np.array(on.bald))]
    )


KINDS = (
    Kind("doubled faces", "duplicate", lambda m, g, _: faces.doubled(m, g, 40), quick_on="hand"),
    Kind("doubled faces, turned", "duplicate", lambda m, g, _: faces.doubled(m, g, 25, turned=True)),
    Kind("repeated corners", "degenerate", lambda m, g, _: faces.repeating_corners(m, g, 30), subjects=SMALL),
    Kind("flat caps", "degenerate", lambda m, g, _: faces.capped(m, g, 30), quick_on="ball"),
    Kind("caps of 1 µm", "degenerate", lambda m, g, _: faces.capped(m, g, 30, 1e-3), subjects=(BODY, HEAD, BALL)),
    Kind("needles of 1 µm", "degenerate", lambda m, g, _: faces.needled(m, g, 20, 1e-3), subjects=(BODY, HAND, BALL)),
    Kind("needles of 1 nm", "degenerate", lambda m, g, _: faces.needled(m, g, 20, 1e-6), subjects=SMALL),
    Kind("triangle soup", "unwelded", lambda m, _g, _: seams.soup(m), quick_on="head"),
    Kind("unwelded patches", "unwelded", lambda m, g, _: seams.parted(m, g, 6)),
    Kind("cracks of 1 µm", "cracks", lambda m, g, _: seams.parted(m, g, 6, 1e-3), subjects=SMALL),
    Kind("cracks of 0.05 mm", "cracks", lambda m, g, _: seams.parted(m, g, 5, 0.05), lambda _: 0.06, quick_on="ball"),
    Kind("cracks of 0.5 mm", "cracks", lambda m, g, _: seams.parted(m, g, 3, 0.5), lambda _: 0.6),
    Kind("T-junctions", "t_junctions", lambda m, g, _: seams.with_t_junctions(m, g, 30), quick_on="hand"),
    Kind("T-junctions, many on a side", "t_junctions", lambda m, g, _: seams.with_t_junctions(m, g, 10, 4), subjects=SMALL),
    Kind("a tenth of faces flipped", "flipped", lambda m, g, _: faces.flipped(m, g, 0.1), quick_on="ball"),
    Kind("a patch flipped", "flipped", lambda m, g, on: faces.flipped_patch(m, g, 6 * on.edge_mm), subjects=(BODY, HAND)),
    Kind("inside out", "inward", lambda m, _g, _: inside_out(m), quick_on="hand"),
    Kind("fins", "edge_not_manifold", lambda m, g, _: joints.finned(m, g, 12), quick_on="head"),
    Kind("flap", "edge_not_manifold", lambda m, g, _: joints.flapped(m, g, 9)),
    Kind("inner wall", "edge_not_manifold", lambda m, _g, _: joints.walled(m, _middle(m), (0.0, 1.0, 0.02)), quick_on="ball"),
    Kind("bodies sharing an edge", "edge_not_manifold", lambda m, g, _: joints.sharing_edges(m, g, 3)),
    Kind("pinch", "vertex_not_manifold", lambda m, g, _: joints.pinched(m, g), lambda edge: 3 * edge, quick_on="hand"),
    Kind("faces missing", "small_holes", lambda m, g, _: holes.without_faces(m, g, 12), share=HOLE_SHARE, quick_on="hand"),
    Kind("many holes", "small_holes", lambda m, g, _: holes.without_rings(m, g, 25, 1), share=HOLE_SHARE),
    Kind("holes of two rings", "holes", lambda m, g, _: holes.without_rings(m, g, 6, 2), share=HOLE_SHARE, quick_on="ball"),
    Kind(
        "ear-sized hole",
        "large_holes",
        lambda m, _g, on: holes.without_ball(m, _at(m, on.bald), on.reach_mm),
        share=HOLE_SHARE,
        quick_on="head",
    ),
    Kind(
        "hole with an islet",
        "large_holes",
        lambda m, _g, on: holes.without_ball(m, _at(m, on.bald), on.reach_mm, 0.5 * on.reach_mm),
        share=HOLE_SHARE,
        subjects=(HEAD, BALL),
    ),
    Kind(
        "hole across a crease",
        "crease_holes",
        lambda m, _g, on: holes.without_ball(m, extreme(m, on.crease), 3.5 * on.edge_mm),
        share=CREASE_SHARE,
        subjects=(HEAD, HAND, CUBE),
    ),
    Kind(
        "naive offset by 1.5 mm",
        "folds",
        lambda m, _g, on: folds.offset_naively(m, _at(m, on.flap), 45.0, 1.5),
        lambda edge: 1.5 + 0.3 * edge,
        subjects=(BODY, HEAD),
    ),
    Kind(
        "naive offset by 2 mm",
        "folds",
        lambda m, _g, on: folds.offset_naively(m, _at(m, on.flap), 45.0, 2.0),
        lambda edge: 2.0 + 0.3 * edge,
        subjects=(BODY, HEAD),
        quick_on="head",
    ),
    Kind(
        "naive offset by 3 mm",
        "folds",
        lambda m, _g, on: folds.offset_naively(m, _at(m, on.flap), 45.0, 3.0),
        lambda edge: 3.0 + 0.3 * edge,
        subjects=(BODY, HEAD, HAND),
    ),
    Kind(
        "naive offset of toes by 2 mm",
        "folds",
        lambda m, _g, _: folds.offset_naively(m, np.array(TOES), 80.0, 2.0),
        lambda edge: 2.0 + 0.3 * edge,
        subjects=(BODY,),
    ),
    Kind("vertices folded over", "folds", lambda m, g, _: folds.folded(m, g, 6), lambda edge: edge, quick_on="ball"),
    Kind(
        "crumpled patch",
        "folds",
        lambda m, g, on: folds.crumpled(m, _at(m, on.flap), 12.0, g),
        lambda edge: 2.0 * edge,
    ),
    Kind(
        "vertex pulled through",
        "folds",
        lambda m, _g, on: folds.pierced(m, _at(m, on.bald), 70.0),
        lambda edge: edge,
        subjects=(HAND, BALL),
    ),
    Kind("crumbs inside", "inner_fragments", lambda m, g, on: dirt.with_crumbs(m, g, 5, 0.15 * on.edge_mm, -0.5 * on.edge_mm)),
    Kind(
        "sheet inside",
        "inner_fragments",
        lambda m, _g, on: dirt.with_inner_sheet(m, _inside(m, on), on.edge_mm),
        subjects=(BODY, HEAD, BALL),
        quick_on="ball",
    ),
    Kind(
        "crumbs outside",
        "debris",
        lambda m, g, on: dirt.with_crumbs(m, g, 8, 0.3 * on.edge_mm, 1.5 * on.edge_mm),
        quick_on="hand",
    ),
    Kind("scraps outside", "debris", lambda m, g, on: dirt.with_scraps(m, g, 8, 0.3 * on.edge_mm, 1.5 * on.edge_mm)),
)
