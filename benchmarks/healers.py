"""Ways to mend a surface: ours, and what people use today with the settings their documentation suggests."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pymeshfix
import pymeshlab
import trimesh

from core.geometry.coincidence import position_ids
from core.healing.heal import heal
from core.mesh import Mesh
from subjects.defects import Defective
from subjects.healing_trial import heal_inputs

Healer = Callable[[Mesh, Defective], Mesh]
MERGE_MM = 0.01  # vertices nearer than this are one, where a tool wants to be told
LARGEST_HOLE_EDGES = 1000
SMALL_PERCENT = 20  # of the diagonal: smaller pieces go


def integument(mesh: Mesh, entry: Defective) -> Mesh:
    """The process `heal`, with its own proof."""
    return heal(mesh, heal_inputs(entry)).mesh


def meshfix(mesh: Mesh, _entry: Defective) -> Mesh:
    """MeshFix (Attene) with its defaults: the largest component, holes filled, bad faces removed and refilled.

    Vertices at equal places are joined first, as its own reader of STL does."""
    ids = position_ids(mesh.vertices)
    used, corners = np.unique(ids[mesh.faces], return_inverse=True)
    fixer = pymeshfix.MeshFix(mesh.vertices[used], corners.reshape(-1, 3))
    fixer.repair()
    return Mesh.of(fixer.points, fixer.faces)


def meshlab_gentle(mesh: Mesh, _entry: Defective) -> Mesh:
    """MeshLab's repair filters that move nothing, then holes closed."""
    work = _meshlab(mesh)
    work.meshing_remove_duplicate_vertices()
    work.meshing_remove_duplicate_faces()
    work.meshing_remove_null_faces()
    return _meshlab_closed(work)


def meshlab_thorough(mesh: Mesh, _entry: Defective) -> Mesh:
    """All of MeshLab's repair filters: also near vertices merged, borders snapped, T-vertices and folded faces removed, faces
    that intersect deleted and the holes closed."""
    work = _meshlab(mesh)
    work.meshing_remove_duplicate_vertices()
    work.meshing_merge_close_vertices(threshold=pymeshlab.PureValue(MERGE_MM))
    work.meshing_snap_mismatched_borders()
    work.meshing_remove_duplicate_faces()
    work.meshing_remove_null_faces()
    work.meshing_remove_t_vertices()
    work.meshing_remove_folded_faces()
    work.compute_selection_by_self_intersections_per_face()
    work.meshing_remove_selected_faces()
    return _meshlab_closed(work)


def _meshlab(mesh: Mesh) -> pymeshlab.MeshSet:
    work = pymeshlab.MeshSet()
    work.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.faces))
    return work


def _meshlab_closed(work: pymeshlab.MeshSet) -> Mesh:
    """Manifold, small pieces dropped, holes closed, faces outward."""
    work.meshing_repair_non_manifold_edges()
    work.meshing_repair_non_manifold_vertices()
    work.meshing_remove_connected_component_by_diameter(mincomponentdiag=pymeshlab.PercentageValue(SMALL_PERCENT))
    work.meshing_re_orient_faces_coherently()
    work.meshing_close_holes(maxholesize=LARGEST_HOLE_EDGES)
    work.meshing_re_orient_faces_by_geometry()
    work.meshing_remove_unreferenced_vertices()
    current = work.current_mesh()
    return Mesh.of(current.vertex_matrix(), current.face_matrix())


def trimesh_repair(mesh: Mesh, _entry: Defective) -> Mesh:
    """trimesh: merged, cleaned, the largest piece, holes of three and four edges filled, normals made consistent."""
    work = trimesh.Trimesh(mesh.vertices, mesh.faces, process=True)
    work.update_faces(work.unique_faces() & work.nondegenerate_faces())
    pieces = work.split(only_watertight=False)
    if len(pieces) > 1:
        work = max(pieces, key=lambda piece: piece.area)
    work.fill_holes()
    trimesh.repair.fix_normals(work)
    work.remove_unreferenced_vertices()
    return Mesh.of(work.vertices, work.faces)


HEALERS: dict[str, Healer] = {
    "integument": integument,
    "pymeshfix": meshfix,
    "pymeshlab, gentle filters": meshlab_gentle,
    "pymeshlab, all repair filters": meshlab_thorough,
    "trimesh, all repairs": trimesh_repair,
}
