"""Bodies whose parts touch and are grown together: arms lowered into the torso, and solids with contacts known by formula."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import manifold3d
import numpy as np
from igl.copyleft.cgal import mesh_boolean

from core.mesh import Mesh
from subjects.people import person

Turn = tuple[str, tuple[float, float, float]]


def balls_grown_together(radius_mm: float, apart_mm: float, facets: int = 64) -> Mesh:
    """Two balls beside each other along x, one around the origin; their contact is a disc of radius √(r² - (d/2)²)."""
    ball = manifold3d.Manifold.sphere(radius_mm, facets)
    return _mesh(ball + ball.translate((apart_mm, 1.3e-2, 0.7e-2)))


def closed_ring(overlap_mm: float) -> Mesh:
    """A tube of radius 10 mm bent to most of a ring of radius 40 mm around z, whose round ends at +x are grown together.

    The contact is a disc near (40, 0, 0); opening it turns a ring (genus 1) into a bent sausage (genus 0)."""
    angle = np.arcsin((10.0 - overlap_mm / 2) / 40.0)  # the ends' middles are 20 mm less the overlap apart
    circle = manifold3d.CrossSection.circle(10.0, 40).translate((40.0, 0.0))
    bent = circle.revolve(96, 360.0 - 2 * np.degrees(angle)).rotate((0.0, 0.0, np.degrees(angle)))
    cap = manifold3d.Manifold.sphere(9.9999, 40)
    ends = [cap.translate((40.0 * np.cos(angle), way * 40.0 * np.sin(angle), 0.0)) for way in (1.0, -1.0)]
    return _mesh(bent + ends[0] + ends[1])


def crossing_ring(overlap_mm: float) -> Mesh:
    """The same ring bent of one sausage whose round ends run into each other near (40, 0, 0) and are not grown together.

    A ball by its topology, and it crosses itself; united it is a ring (genus 1)."""
    length = 80.0 * np.pi + overlap_mm - 20.0  # between the middles of the round ends
    rod = manifold3d.Manifold.cylinder(length, 10.0, circular_segments=40, center=True).refine_to_length(5.0)
    ends = [manifold3d.Manifold.sphere(10.0, 40).translate((0.0, 0.0, way * length / 2)) for way in (-1.0, 1.0)]
    straight = _mesh(rod + ends[0] + ends[1])
    across, up, along = straight.vertices.T
    angle = np.pi + along / 40.0
    bent = np.column_stack(((40.0 + across) * np.cos(angle), (40.0 + across) * np.sin(angle), -up))
    return straight.with_vertices(bent).rounded_to_float32()


@lru_cache(maxsize=4)
def grown_together(turns: Sequence[Turn]) -> Mesh:
    """A person with bones turned so far that parts run into each other, as one surface: the union of the body with itself.

    By exact arithmetic; the far tetrahedron, taken off again, is what the call wants."""
    mesh = person(turns=turns)
    far = 1e5 + np.vstack((np.zeros(3), np.eye(3)))
    corners = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    vertices, faces, birth = mesh_boolean(mesh.vertices, mesh.faces.astype(np.int64), far, corners, "union")
    used, numbered = np.unique(faces[birth < len(mesh.faces)], return_inverse=True)
    return Mesh.of(vertices[used], numbered.reshape(-1, 3)).rounded_to_float32()


def arms_lowered(degrees: float) -> tuple[Turn, Turn]:
    """Both upper arms turned down from the pose of the base body; from 38 degrees on they run into the torso."""
    return ("upperarm01.L", (0.0, 0.0, -degrees)), ("upperarm01.R", (0.0, 0.0, degrees))


def legs_closed(degrees: float) -> tuple[Turn, Turn, Turn, Turn]:
    """Both thighs turned inwards until they run into each other, from 15 degrees on; from the knees down the legs turn back, so
    that the feet stay apart. At 17 degrees the thighs share 211 cm² over 30 cm, 44 mm deep."""
    back = degrees + 4.0
    return (
        ("upperleg01.L", (0.0, 0.0, -degrees)),
        ("upperleg01.R", (0.0, 0.0, degrees)),
        ("lowerleg01.L", (0.0, 0.0, back)),
        ("lowerleg01.R", (0.0, 0.0, -back)),
    )


def feet_turned_in(degrees: float) -> tuple[Turn, Turn]:
    """Straight legs turned inwards until the feet run into each other: at 13 degrees they are 16 mm deep in one another."""
    return ("upperleg01.L", (0.0, 0.0, -degrees)), ("upperleg01.R", (0.0, 0.0, degrees))


def _mesh(solid: manifold3d.Manifold) -> Mesh:
    made = solid.to_mesh64()
    return Mesh.of(np.array(made.vert_properties)[:, :3], np.array(made.tri_verts)).rounded_to_float32()
