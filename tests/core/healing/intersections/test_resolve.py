"""Whatever runs through itself comes out free, with the rest untouched, or is refused by name."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from core.geometry.exact_intersection import find_intersecting_faces
from core.healing.intersections import resolve as module
from core.healing.intersections.resolve import resolve
from core.healing.intersections.short_edges import collapse_short_edges
from core.mesh import Mesh
from subjects.body import body
from subjects.damage.folds import folded, offset_naively, pierced
from subjects.generated.pieces import inside_out, moved, together
from subjects.generated.revolved import ball
from subjects.generated.solid import block

EAR = np.array([87.9, 724.0, 37.5])


def resolved(mesh: Mesh) -> tuple[Mesh, list[str]]:
    vertices, faces, changes = resolve(mesh.vertices, mesh.faces)
    assert len(find_intersecting_faces(vertices, faces)) == 0
    assert np.array_equal(vertices, vertices.astype(np.float32))
    return Mesh.of(vertices, faces), [change.kind for change in changes]


def test_what_is_free_comes_back_as_it_is() -> None:
    mesh = ball(30, 3)
    vertices, faces, changes = resolve(mesh.vertices, mesh.faces)
    assert vertices is mesh.vertices
    assert faces is mesh.faces
    assert changes == []


def test_folded_vertices_go_back_and_others_stay() -> None:
    healthy = ball(30, 4)
    damaged = folded(healthy, np.random.default_rng(5), 6)
    mesh, kinds = resolved(damaged)
    assert kinds == ["folds"]
    assert np.array_equal(mesh.faces, healthy.faces)
    moved_away = (mesh.vertices != damaged.vertices).any(axis=1)
    assert moved_away.sum() <= 12
    assert np.abs(np.linalg.norm(mesh.vertices, axis=1) - 30).max() < 0.1


def test_spike_through_the_other_side_is_drawn_back_alone() -> None:
    damaged = pierced(ball(30, 4), np.array([0, 0, 30.0]), 70.0)
    mesh, kinds = resolved(damaged)
    assert kinds == ["folds"]
    assert (mesh.vertices != damaged.vertices).any(axis=1).sum() == 1
    assert np.abs(np.linalg.norm(mesh.vertices, axis=1) - 30).max() < 0.1


def test_ear_offset_naively_keeps_its_walls_apart() -> None:
    skin = body()
    damaged = offset_naively(skin, EAR, 45.0, 2.0)
    assert len(find_intersecting_faces(damaged.vertices, damaged.faces)) > 50
    mesh, kinds = resolved(damaged)
    assert kinds == ["folds"]  # no union: it would make a hole through the ear
    assert np.array_equal(mesh.faces, skin.faces)
    assert np.linalg.norm(mesh.vertices - damaged.vertices, axis=1).max() < 1.0
    far = np.linalg.norm(skin.vertices - EAR, axis=1) > 46.0
    assert np.array_equal(mesh.vertices[far], skin.vertices[far])


def test_overlapping_pieces_become_one() -> None:
    _mesh, kinds = resolved(together(block(20, 20, 20, 3.0), moved(ball(10, 3), 9.3, 8.1, 7.7)))
    assert kinds == ["overlaps"]


def test_fold_of_a_rounding_error_moves_nothing() -> None:
    """A needle a tenth of a micrometre wide whose tip pokes through a neighbour: the short edge goes."""
    mesh = ball(30, 3)
    a, b, c = (int(corner) for corner in mesh.faces[0])
    across = next(int(face.sum()) - a - b for face in mesh.faces[1:] if a in face and b in face)
    rest = [face.tolist() for face in mesh.faces if not (a in face and b in face)]
    new = len(mesh.vertices)
    faces = np.array([*rest, (a, new, c), (new, b, c), (b, new, across), (new, a, across)], dtype=np.int32)
    directions = np.random.default_rng(0).normal(scale=1e-4, size=(40, 3))
    tries = [np.concatenate((mesh.vertices, [(mesh.vertices[a] + shift).astype(np.float32)])) for shift in directions]
    vertices = next(some for some in tries if len(find_intersecting_faces(some, faces)))
    after, kinds = resolved(Mesh.of(vertices, faces))
    assert kinds == ["short_edges"]
    assert len(after.faces) == len(mesh.faces)


def test_tetrahedron_has_no_edge_to_spare() -> None:
    points = np.array([[0, 0, 0], [1e-6, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], dtype=np.int32)
    assert collapse_short_edges(points, faces, np.arange(4))[2] == []


def test_open_surface_is_left_to_others() -> None:
    damaged = folded(ball(30, 3), np.random.default_rng(5), 2)
    assert resolve(damaged.vertices, damaged.faces[1:])[2] == []


def test_refuses_by_name_with_places(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "ROUNDS", 0)
    damaged = folded(ball(30, 4), np.random.default_rng(5), 3)
    with pytest.raises(InputError, match="3 place") as refusal:
        resolve(damaged.vertices, damaged.faces)
    assert refusal.value.code == "heal.intersections_remain"
    assert len(refusal.value.findings[0].places) == 3


def test_nothing_inside_is_refused() -> None:
    tangled = inside_out(together(ball(10, 2), moved(ball(10, 2), 9.1, 1.3, 0.7)))
    with pytest.raises(InputError) as refusal:
        resolve(tangled.vertices, tangled.faces)
    assert refusal.value.code == "heal.intersections_remain"


def test_equal_input_gives_equal_bytes() -> None:
    damaged = offset_naively(body(), EAR, 45.0, 3.0)
    first, second = (resolved(damaged)[0] for _ in range(2))
    assert first.vertices.tobytes() == second.vertices.tobytes()
    assert first.faces.tobytes() == second.faces.tobytes()
