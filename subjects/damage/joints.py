"""Surfaces that are no manifold: fins, flaps, inner walls, bodies that share an edge or a point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.adjacency import edges
from core.geometry.components import label_connected
from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from subjects.damage.places import Generator, rings_around, some_faces, usual_edge
from subjects.generated.pieces import together

Floats = NDArray[np.float64]


def finned(mesh: Mesh, generator: Generator, count: int) -> Mesh:
    """Single faces that stand on an edge."""
    chosen = some_faces(mesh, generator, count)
    a, b, _ = mesh.faces[chosen].T
    normals = vertex_normals(mesh.vertices, mesh.faces)
    tips = (mesh.vertices[a] + mesh.vertices[b]) / 2 + usual_edge(mesh) * normals[a]
    fins = np.column_stack((a, b, len(mesh.vertices) + np.arange(len(chosen))))
    return Mesh.of(np.concatenate((mesh.vertices, tips)), np.concatenate((mesh.faces, fins))).rounded_to_float32()


def flapped(mesh: Mesh, generator: Generator, length: int) -> Mesh:
    """A sheet that stands on a path of edges."""
    normals = vertex_normals(mesh.vertices, mesh.faces)
    path = [int(generator.choice(mesh.faces.ravel()))]
    ahead = generator.normal(size=3)
    ends = edges(mesh.faces).ends
    while len(path) < length:
        around = ends[(ends == path[-1]).any(axis=1)].sum(axis=1) - path[-1]
        fresh = [int(vertex) for vertex in around if vertex not in path]
        if not fresh:
            break
        path.append(max(fresh, key=lambda vertex: float((mesh.vertices[vertex] - mesh.vertices[path[-1]]) @ ahead)))
    upper = len(mesh.vertices) + np.arange(len(path))
    top = mesh.vertices[path] + 1.5 * usual_edge(mesh) * normals[path]
    lower = np.array(path)
    sheet = [np.column_stack((lower[:-1], lower[1:], upper[:-1])), np.column_stack((lower[1:], upper[1:], upper[:-1]))]
    return Mesh.of(np.concatenate((mesh.vertices, top)), np.concatenate((mesh.faces, *sheet))).rounded_to_float32()


def walled(mesh: Mesh, origin: Floats, normal: tuple[float, float, float]) -> Mesh:
    """An inner wall welded to the surface where a plane, give or take a face, cuts it."""
    above = (mesh.triangles().mean(axis=1) - origin) @ np.array(normal) > 0.0
    found = edges(mesh.faces)
    _edge, pair, side = found.two_faces()
    cut = above[pair[:, 0]] != above[pair[:, 1]]
    upper = np.where(above[pair[cut, 0]], 0, 1)
    rows = np.arange(len(upper))
    face, at = pair[cut][rows, upper], side[cut][rows, upper]
    tails, heads = mesh.faces[face, at], mesh.faces[face, (at + 1) % 3]
    rim, local = np.unique(np.column_stack((tails, heads)), return_inverse=True)
    loops, label = label_connected(len(rim), *local.reshape(-1, 2).T)
    middles = np.array([mesh.vertices[rim[label == loop]].mean(axis=0) for loop in range(loops)])
    tip = len(mesh.vertices) + label[local.reshape(-1, 2)[:, 0]]
    wall = np.column_stack((heads, tails, tip))
    return Mesh.of(np.concatenate((mesh.vertices, middles)), np.concatenate((mesh.faces, wall))).rounded_to_float32()


def sharing_edges(mesh: Mesh, generator: Generator, count: int) -> Mesh:
    """Small closed bodies, tetrahedra, each of which has an edge in common with the surface, outside of it."""
    normals = vertex_normals(mesh.vertices, mesh.faces)
    vertices, faces = [mesh.vertices], [mesh.faces]
    first = len(mesh.vertices)
    for face in some_faces(mesh, generator, count):
        a, b, _ = mesh.faces[face]
        out = normals[a] + normals[b]
        out /= np.linalg.norm(out)
        along = mesh.vertices[b] - mesh.vertices[a]
        sideways = np.cross(along, out)
        middle = (mesh.vertices[a] + mesh.vertices[b]) / 2 + np.linalg.norm(along) * out
        vertices.append(np.array([middle - 0.3 * sideways, middle + 0.3 * sideways]))
        u, v = first, first + 1
        first += 2
        faces.append(np.array([[a, b, v], [b, a, u], [u, v, b], [v, u, a]], dtype=np.int32))
    return Mesh.of(np.concatenate(vertices), np.concatenate(faces)).rounded_to_float32()


def twin_across_edge(mesh: Mesh) -> Mesh:
    """The surface and its like, turned about an outermost edge: two closed bodies with one edge in common."""
    ends = edges(mesh.faces).ends
    far = int((mesh.vertices[ends].mean(axis=1) @ np.array([1.0, 0.31, 0.17])).argmax())
    a, b = mesh.vertices[ends[far]]
    along = (b - a) / np.linalg.norm(b - a)
    arm = mesh.vertices - a
    turned = a + 2 * (arm @ along)[:, None] * along - arm  # half a turn
    both = together(mesh, mesh.with_vertices(turned))
    shared = ends[far] + len(mesh.vertices)
    faces = both.faces.copy()
    for twin, own in zip(shared, ends[far], strict=True):
        faces[faces == twin] = own
    return Mesh.of(both.vertices, faces).rounded_to_float32()


def pinched(mesh: Mesh, generator: Generator, rings: int = 4) -> Mesh:
    """Two vertices some edges apart, as near in space as there are, drawn together into one."""
    order = generator.permutation(np.unique(mesh.faces))[:400]
    best, pair = np.inf, (0, 0)
    for vertex in order:
        others = np.flatnonzero(~rings_around(mesh, [int(vertex)], rings))
        distance, nearest = cKDTree(mesh.vertices[others]).query(mesh.vertices[vertex])
        if distance < best:
            best, pair = float(distance), (int(vertex), int(others[nearest]))
    vertices, faces = mesh.vertices.copy(), mesh.faces.copy()
    vertices[pair[0]] = (vertices[pair[0]] + vertices[pair[1]]) / 2
    faces[faces == pair[1]] = pair[0]
    return Mesh.of(vertices, faces).rounded_to_float32()
