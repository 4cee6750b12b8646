import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from core.geometry.adjacency import edges, vertex_faces, vertex_neighbours
from tests.solids import tetrahedron, torus

any_faces = st.lists(st.tuples(*[st.integers(0, 5)] * 3), min_size=1, max_size=12).map(lambda rows: np.array(rows, np.int32))


def test_edges_of_a_tetrahedron():
    table = edges(tetrahedron().faces)
    assert table.ends.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    assert table.face_count.tolist() == [2] * 6
    # face 0 is (0, 2, 1): sides 0-2, 2-1, 1-0
    assert table.of_face[0].tolist() == [1, 3, 0]
    assert table.forward[0].tolist() == [True, False, False]


def test_two_faces_name_both_sides():
    mesh = torus()
    table = edges(mesh.faces)
    edge, face, side = table.two_faces()
    assert len(edge) == len(table.ends) == 3 * len(mesh.faces) // 2
    assert (face[:, 0] < face[:, 1]).all()
    assert (table.of_face[face[:, 0], side[:, 0]] == edge).all()
    assert (table.of_face[face[:, 1], side[:, 1]] == edge).all()


@given(any_faces)
def test_tables_agree_with_dictionaries(faces):
    table = edges(faces)
    counts: dict[tuple[int, int], int] = {}
    for a, b, c in faces.tolist():
        for tail, head in ((a, b), (b, c), (c, a)):
            key = (min(tail, head), max(tail, head))
            counts[key] = counts.get(key, 0) + 1
    assert {tuple(ends): count for ends, count in zip(table.ends.tolist(), table.face_count.tolist(), strict=True)} == counts
    around = vertex_faces(faces, 6)
    neighbours = vertex_neighbours(table.ends, 6)
    for vertex in range(6):
        assert around[vertex].tolist() == [f for f, face in enumerate(faces.tolist()) for corner in face if corner == vertex]
        ring = {b if a == vertex else a for a, b in counts if vertex in (a, b) and a != b}
        assert neighbours[vertex].tolist() == sorted(ring)


def test_no_faces_have_no_edges():
    assert len(edges(np.empty((0, 3), dtype=np.int32)).ends) == 0
