"""Solids cut and joined exactly (manifold3d), as meshes."""

from __future__ import annotations

import manifold3d
import numpy as np

from core.mesh import Mesh


def mesh_of(solid: manifold3d.Manifold, longest_mm: float | None = None) -> Mesh:
    """The surface of a solid, its sides split to at most longest_mm; as closed and oriented as the solid."""
    fine = solid if longest_mm is None else solid.refine_to_length(longest_mm)
    made = fine.to_mesh()
    return Mesh.of(np.asarray(made.vert_properties)[:, :3], np.asarray(made.tri_verts)).rounded_to_float32()


def block(x: float, y: float, z: float, longest_mm: float | None = None) -> Mesh:
    """A box around the origin, sides in mm."""
    return mesh_of(manifold3d.Manifold.cube((x, y, z), True), longest_mm)


def gear(radius_mm: float, teeth: int, thickness_mm: float, longest_mm: float) -> Mesh:
    """A toothed disc with square teeth a tenth of its radius deep: concave and convex right angles in turn."""
    angle = 2 * np.pi * np.arange(2 * teeth) / (2 * teeth)
    outer = np.where(np.arange(2 * teeth) % 2 == 0, 1.0, 0.9) * radius_mm
    width = np.pi / (2 * teeth) * 0.9
    outline = np.column_stack(
        (
            np.repeat(outer, 2) * np.cos(np.repeat(angle, 2) + np.tile((-width, width), 2 * teeth)),
            np.repeat(outer, 2) * np.sin(np.repeat(angle, 2) + np.tile((-width, width), 2 * teeth)),
        )
    )
    return mesh_of(manifold3d.Manifold.extrude(manifold3d.CrossSection([outline]), thickness_mm), longest_mm)


def comb(fingers: int, width_mm: float, slit_mm: float, longest_mm: float) -> Mesh:
    """Fingers on a palm with slits of `slit_mm` between them."""
    pitch = width_mm + slit_mm
    length, palm = 6 * width_mm, 2 * width_mm
    solid = manifold3d.Manifold.cube((fingers * pitch - slit_mm, palm, width_mm))
    for finger in range(fingers):
        bar = manifold3d.Manifold.cube((width_mm, length, width_mm)).translate((finger * pitch, palm / 2, 0.0))
        solid = solid + bar
    return mesh_of(solid, longest_mm)


def near_touching_fingers(radius_mm: float, slit_mm: float, longest_mm: float) -> Mesh:
    """Two round fingers side by side on one block, as near as `slit_mm`."""
    finger = manifold3d.Manifold.cylinder(8 * radius_mm, radius_mm, radius_mm, 48) + manifold3d.Manifold.sphere(
        radius_mm, 48
    ).translate((0, 0, 8 * radius_mm))
    apart = radius_mm + slit_mm / 2
    root = manifold3d.Manifold.cube((6 * radius_mm, 3 * radius_mm, 3 * radius_mm), True).translate((0, 0, -radius_mm))
    return mesh_of(root + finger.translate((apart, 0, 0)) + finger.translate((-apart, 0, 0)), longest_mm)


def needle(length_mm: float, radius_mm: float, sides: int, longest_mm: float | None) -> Mesh:
    """A double cone: sharp at both ends."""
    half = manifold3d.Manifold.cylinder(length_mm / 2, radius_mm, 0.0, sides)
    return mesh_of(half + half.mirror((0, 0, 1)), longest_mm)


def bowl(radius_mm: float, wall_mm: float, segments: int) -> Mesh:
    """Half a sphere with a wall thinner than it is wide: an outer ear in the rough."""
    hollow = manifold3d.Manifold.sphere(radius_mm, segments) - manifold3d.Manifold.sphere(radius_mm - wall_mm, segments)
    below = manifold3d.Manifold.cube((3 * radius_mm, 3 * radius_mm, 3 * radius_mm), True).translate((0, 0, -1.5 * radius_mm))
    return mesh_of(hollow - below)


def hollow_ball(radius_mm: float, wall_mm: float, segments: int) -> Mesh:
    """A ball with an internal cavity: two surfaces, so not one skin."""
    return mesh_of(manifold3d.Manifold.sphere(radius_mm, segments) - manifold3d.Manifold.sphere(radius_mm - wall_mm, segments))


def drilled_block(side_mm: float, hole_radius_mm: float, longest_mm: float) -> Mesh:
    """A cube with three crossing holes: genus 5."""
    bar = manifold3d.Manifold.cylinder(2 * side_mm, hole_radius_mm, hole_radius_mm, 32, True)
    cube = manifold3d.Manifold.cube((side_mm, side_mm, side_mm), True)
    return mesh_of(cube - bar - bar.rotate((90, 0, 0)) - bar.rotate((0, 90, 0)), longest_mm)


def person_in(mesh: Mesh, low: tuple[float, float, float], high: tuple[float, float, float]) -> Mesh:
    """The part of a mesh inside a box, closed by the box's walls: a head cut off at the neck, a hand at the wrist."""
    solid = manifold3d.Manifold(manifold3d.Mesh(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32)))
    size = np.subtract(high, low)
    return mesh_of(solid ^ manifold3d.Manifold.cube(size).translate(low))
