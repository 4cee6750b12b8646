"""`literal` against a plain transcription of the thesis' Appendix A, as slow as the script itself."""

from __future__ import annotations

import numpy as np

from core.decimation.decimate import decimate
from core.decimation.literal import collapse_literally
from core.mesh import Mesh
from core.schema.decimate import DecimateInputs
from tests.solids import sphere

ITERATIONS = 25
WEIGHT = 0.8


def bumpy(subdivisions: int) -> Mesh:
    """A surface without symmetries, so that no two faces are equally flat."""
    base = sphere(30.0, subdivisions)
    noise = np.random.default_rng(7).normal(0.0, 0.05, base.vertices.shape)
    return base.with_vertices(base.vertices + 2.0 * np.sin(base.vertices[:, [1, 2, 0]] / 6.0) + noise)


def appendix_a(P: np.ndarray, t: np.ndarray, iterations: int) -> tuple[np.ndarray, np.ndarray]:
    """The script, line by line: P (V, 3), t (F, 3). Deleted points stay in P, as there."""
    P, t = P.copy(), t.copy()
    for _ in range(iterations):
        normals = np.cross(P[t[:, 1]] - P[t[:, 0]], P[t[:, 2]] - P[t[:, 0]])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        avg_angs = np.zeros(len(t))
        for i in range(len(t)):
            n_t = set()
            for u, v in ((t[i, 0], t[i, 1]), (t[i, 1], t[i, 2]), (t[i, 0], t[i, 2])):
                n_t |= set(np.flatnonzero((t == u).any(axis=1))) & set(np.flatnonzero((t == v).any(axis=1)))
            angles = [subspace(normals[i], normals[j]) for j in sorted(n_t)]
            avg_angs[i] = sum(angles) / len(angles)
        s_t = t[np.argmin(avg_angs)]
        sides = ((s_t[0], s_t[1]), (s_t[1], s_t[2]), (s_t[2], s_t[0]))
        s_e = sides[int(np.argmin([np.linalg.norm(P[u] - P[v]) for u, v in sides]))]
        t[t == s_e[0]] = s_e[1]
        lp_nodes = attached(t, s_e[1])
        lp_nodes = sorted(set(lp_nodes).union(*(attached(t, node) for node in lp_nodes)))
        t = t[(t[:, 0] != t[:, 1]) & (t[:, 1] != t[:, 2]) & (t[:, 2] != t[:, 0])]
        moved = P.copy()
        for node in lp_nodes:
            around = [other for other in attached(t, node) if other != node]
            moved[node] = (1 - WEIGHT) * P[node] + WEIGHT * P[around].mean(axis=0)
        P = moved
    return P, t


def attached(t: np.ndarray, node: int) -> list[int]:
    return [int(other) for other in np.unique(t[(t == node).any(axis=1)])]


def subspace(a: np.ndarray, b: np.ndarray) -> float:
    """MATLAB's, of two lines."""
    return float(np.arcsin(min(1.0, np.linalg.norm(b - a * (a @ b)))))


def test_25_iterations_are_those_of_the_script():
    mesh = bumpy(2)
    points, faces = appendix_a(mesh.vertices, mesh.faces.astype(np.int64), ITERATIONS)
    made = collapse_literally(mesh, len(mesh.faces) - 2 * ITERATIONS, WEIGHT)
    assert made.attempts == {"done": ITERATIONS}
    assert len(made.mesh.faces) == len(faces)
    used, corner = np.unique(faces, return_inverse=True)
    assert np.array_equal(made.mesh.faces, corner.reshape(-1, 3))
    assert np.allclose(made.mesh.vertices, points[used], atol=5e-6)  # float32 on the way out


def test_the_script_has_no_guards_and_says_so():
    """Thinned to very little, a surface with features folds; nothing is raised, it is there for comparison."""
    mesh = bumpy(3)
    result = decimate(
        {"it": mesh},
        DecimateInputs(mesh={"href": "/v1/meshes/00000000-0000-4000-8000-000000000000"}, target_faces=200, literal=True),
    )["it"]
    assert len(result.mesh.faces) <= 200
    assert result.changes[0]["method"] == "literal"
    assert result.max_deviation_mm > 0.5  # Laplacian smoothing shrinks
