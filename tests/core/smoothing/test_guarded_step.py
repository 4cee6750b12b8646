"""One step under guard: taken whole where it holds, shortened where it does not."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.clearance import Clearance
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas
from core.geometry.quality import quality
from core.geometry.volume import signed_volumes
from core.mesh import Mesh
from core.smoothing.company import Company
from core.smoothing.guarded_step import GuardedSurface
from core.smoothing.progress import measure_progress
from core.smoothing.spoiled_faces import find_spoiled
from tests.solids import flipped, octahedron, sphere, together


def guarded(mesh: Mesh, gap_mm: float = 0.05) -> GuardedSurface:
    return GuardedSurface.of(mesh.rounded_to_float32(), np.arange(len(mesh.vertices)), Clearance(gap_mm, 0.01, ()))


def test_a_harmless_step_is_taken_whole():
    mesh = sphere(10.0, 2).rounded_to_float32()
    state = guarded(mesh)
    step = state.step(0.5 * mesh.vertices, (), 0.0)
    assert (step.moved, step.shortened, step.held) == (len(mesh.vertices), 0, 0)
    assert (state.vertices == 0.5 * mesh.vertices).all()


def test_only_what_breaks_is_shortened():
    # one vertex of a sphere is sent through the other side; its neighbours' faces are all that is concerned
    mesh = sphere(10.0, 2).rounded_to_float32()
    proposal = 0.9 * mesh.vertices
    proposal[0] = -1.5 * mesh.vertices[0]
    state = guarded(mesh)
    step = state.step(proposal, (), 0.05)
    assert step.shortened + step.held > 0
    assert len(find_intersecting_faces(state.vertices, mesh.faces)) == 0
    apart = np.ones(len(mesh.vertices), dtype=bool)
    apart[np.unique(mesh.faces[(mesh.faces == 0).any(axis=1)])] = False
    far = apart & (np.linalg.norm(mesh.vertices - mesh.vertices[0], axis=1) > 8.0) & (mesh.vertices @ mesh.vertices[0] > -90.0)
    assert state.vertices[far] == pytest.approx(0.9 * mesh.vertices[far], abs=1e-6)
    assert state.restrained[0] == 1


def test_an_obstacle_is_kept_away_from():
    mesh, wall = sphere(10.0, 3).rounded_to_float32(), sphere(9.0, 3)
    state = guarded(mesh, gap_mm=0.5)
    state.step(0.93 * mesh.vertices, (FaceTree.of(wall.vertices, wall.faces),), 0.05)
    radii = np.linalg.norm(state.vertices, axis=1)
    assert radii.min() > 9.5
    assert radii.max() < 10.0


def test_a_step_into_nothing_ends():
    mesh = octahedron(10.0)
    state = guarded(mesh)
    step = state.step(np.zeros_like(mesh.vertices), (), 0.05)
    assert step.held + step.shortened == 6
    assert quality(state.vertices, mesh.faces).min() > 0.05


def test_spoiled_faces_are_those_numpy_finds():
    rng = np.random.default_rng(3)
    mesh = sphere(10.0, 2)
    after = mesh.vertices + rng.normal(0.0, 1.5, mesh.vertices.shape)
    least = rng.uniform(0.0, 0.9, len(mesh.faces))
    asked = np.flatnonzero(rng.random(len(mesh.faces)) < 0.7)
    before, then = (np.cross(v[mesh.faces[:, 1]] - v[mesh.faces[:, 0]], v[mesh.faces[:, 2]] - v[mesh.faces[:, 0]])
                    for v in (mesh.vertices, after))  # fmt: skip
    wanted = ((before * then).sum(axis=1) <= 0) | (quality(after, mesh.faces) < least)
    found = find_spoiled(mesh.vertices, after, mesh.faces, asked, least)
    assert 0 < len(found) < len(asked)
    assert (found == asked[wanted[asked]]).all()


def test_progress_is_what_the_geometry_says():
    mesh = sphere(10.0, 2, at=(1000.0, -500.0, 3.0))
    moved = mesh.vertices + np.array((0.0, 3.0, 4.0))
    asked = np.arange(5, 40)
    state = measure_progress(2, moved, mesh.vertices, mesh.faces, asked, closed=True, moved=7)
    q = quality(moved, mesh.faces[asked])
    assert (state.lowest_quality, state.mean_quality) == (q.min(), pytest.approx(q.mean()))
    assert state.area_mm2 == pytest.approx(face_areas(moved, mesh.faces).sum())
    volume = signed_volumes(moved, mesh.faces, np.zeros(len(mesh.faces), dtype=np.int64))[0]
    assert state.volume_mm3 == pytest.approx(volume)
    assert state.largest_shift_mm == pytest.approx(5.0)
    assert measure_progress(2, moved, moved, mesh.faces, asked, closed=False).volume_mm3 is None


def test_company_tells_a_jump_from_a_move():
    outer, inner = octahedron(10.0), octahedron(5.0)
    company = Company({"outer": outer, "inner": inner})
    assert company.admits("outer", 0.8 * outer.vertices, outer.faces)
    assert not company.admits("outer", 0.4 * outer.vertices, outer.faces)  # inside the inner one now
    assert not company.admits("inner", inner.vertices + np.array((50.0, 0.0, 0.0)), inner.faces)  # beside the outer one
    assert not company.admits("outer", -outer.vertices, outer.faces)  # inside out
    # a refused place does not count: the inner one may still grow to just below 0.8 of the outer
    assert company.admits("inner", 1.5 * inner.vertices, inner.faces)


def test_company_knows_the_pieces_of_one_surface():
    hollow = together(octahedron(10.0), flipped(octahedron(5.0)))
    company = Company({"hollow": hollow})
    shrunk = hollow.vertices * np.repeat([0.4, 1.0], 6)[:, None]
    assert not company.admits("hollow", shrunk, hollow.faces)
    assert company.admits("hollow", 0.4 * hollow.vertices, hollow.faces)
