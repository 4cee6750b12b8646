"""How far a coil is from a surface."""

from __future__ import annotations

import numpy as np

from core.coil import Coil
from core.geometry.adjacency import edges
from core.geometry.containment import is_inside
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from core.schema.report import CoilReport


def measure_coil(coil: Coil, name: str, surface: Mesh) -> CoilReport:
    """Of all dipoles and pieces of wire to the surface called `name`; who is inside is told of closed surfaces alone."""
    tree, places = FaceTree.of(surface.vertices, surface.faces), coil.places()
    distance, _, _ = closest_points_in(tree, places)
    nearest = int(np.argmin(distance))
    x, y, z = places[nearest]
    closed = bool((edges(surface.faces).face_count == 2).all())
    inside = int(is_inside(tree, places).sum()) if closed else 0
    return CoilReport(
        dipoles=len(coil.positions),
        wire_pieces=len(coil.wire),
        surface=name,
        distance_mm=float(distance[nearest]),
        nearest_at_mm=(float(x), float(y), float(z)),
        inside=inside,
    )
