"""Better triangles in a band: long edges halved, edges flipped, the new vertices smoothed. The rims stay."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges, vertex_faces, vertex_neighbours
from core.geometry.normals import face_crosses
from core.geometry.quality import quality
from core.mesh import Faces

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDS = 6
TOO_LONG = 1.5  # times the length of the rim edges nearby
GOOD = 0.4  # q above which smoothing need not raise it
SMALLEST_GAIN = 1e-6  # of q, so that equal triangles are not flipped back and forth
LARGEST_TURN = 0.5  # cosine: a flipped pair may not look elsewhere than the pair before
FLIP_SWEEPS = 30


def refine_band(vertices: Floats, band: Faces, present: Ints, draw: Callable[[Floats], Floats]) -> tuple[Floats, Faces]:
    """Improve a band that lies between rims.

    Needs:    vertices (V, 3) mm; band (B, 3) faces; present (K, 2): edges between rim vertices
              that lie outside the band; draw: places (N, 3) on the surface the band should follow for points (N, 3).
    Promises: the first V vertices keep place and number, new ones follow; the sides of the band are the same edges.
    """
    rim_count = len(vertices)
    taken = {(int(a), int(b)) for a, b in np.sort(present, axis=1)}
    size = _rim_sizes(vertices, band)
    for _ in range(ROUNDS):
        band = _flip(vertices, band, taken)
        vertices, band, size, halved = _halve(vertices, band, size)
        band = _flip(vertices, band, taken)
        vertices = _smooth(vertices, band, rim_count, draw)
        if not halved:
            break
    return vertices, _flip(vertices, band, taken)


def _rim_sizes(vertices: Floats, band: Faces) -> Floats:
    """Mean length of the rim edges at each vertex, (V,); 0 away from the rims."""
    found = edges(band)
    rim = found.ends[found.face_count == 1]
    length = np.linalg.norm(vertices[rim[:, 0]] - vertices[rim[:, 1]], axis=1)
    weight = np.bincount(rim.ravel(), minlength=len(vertices))
    total = np.bincount(rim.ravel(), weights=np.repeat(length, 2), minlength=len(vertices))
    sizes: Floats = np.divide(total, weight, out=np.zeros(len(vertices)), where=weight > 0)
    return sizes


def _halve(vertices: Floats, band: Faces, size: Floats) -> tuple[Floats, Faces, Floats, int]:
    """Put a vertex into the middle of inner edges that are too long, the longest first, one per face at most."""
    found = edges(band)
    edge, pair, _side = found.two_faces()
    a, b = found.ends[edge].T
    length = np.linalg.norm(vertices[a] - vertices[b], axis=1)
    excess = length / ((size[a] + size[b]) / 2)
    points, faces, sizes = list(vertices), [tuple(face) for face in band.tolist()], size.tolist()
    used: set[int] = set()
    halved = 0
    for number in np.argsort(-excess, kind="stable"):
        if excess[number] <= TOO_LONG:
            break
        first, second = int(pair[number, 0]), int(pair[number, 1])
        if first in used or second in used:
            continue
        used |= {first, second}
        start, end = int(a[number]), int(b[number])
        middle = len(points)
        points.append((vertices[start] + vertices[end]) / 2)
        sizes.append((size[start] + size[end]) / 2)
        for face in (first, second):
            corners = faces[face]
            faces[face] = tuple(middle if corner == end else corner for corner in corners)
            faces.append(tuple(middle if corner == start else corner for corner in corners))
        halved += 1
    return np.array(points), np.array(faces, dtype=np.int32), np.array(sizes), halved


def _flip(vertices: Floats, band: Faces, taken: set[tuple[int, int]]) -> Faces:
    """Turn inner edges where that lifts the worse q of the two faces and makes no edge that is there already."""
    band = band.copy()
    for _ in range(FLIP_SWEEPS):
        gain, pair, apex, sharp = _flip_gains(vertices, band)
        present = {(int(a), int(b)) for a, b in edges(band).ends} | taken
        touched = np.zeros(len(band), dtype=bool)
        flipped = False
        for number in np.argsort(-gain, kind="stable"):
            if gain[number] <= SMALLEST_GAIN:
                break
            first, second = pair[number]
            (c, d), (a, b) = apex[number], sharp[number]
            key = (int(min(c, d)), int(max(c, d)))
            if touched[first] or touched[second] or key in present:
                continue
            touched[[first, second]] = True
            present.add(key)
            band[first], band[second] = (c, a, d), (d, b, c)
            flipped = True
        if not flipped:
            break
    return band


def _flip_gains(vertices: Floats, band: Faces) -> tuple[Floats, Ints, Ints, Ints]:
    """For each inner edge: gain of q by a flip (N,), faces (N, 2), their apexes c d (N, 2), ends a b in the first face (N, 2)."""
    found = edges(band)
    _edge, pair, side = found.two_faces()
    a, b = band[pair[:, 0], side[:, 0]], band[pair[:, 0], (side[:, 0] + 1) % 3]
    c, d = band[pair[:, 0], (side[:, 0] + 2) % 3], band[pair[:, 1], (side[:, 1] + 2) % 3]
    old = [np.column_stack(corners) for corners in ((a, b, c), (b, a, d))]
    new = [np.column_stack(corners) for corners in ((c, a, d), (d, b, c))]
    before = np.minimum(*(quality(vertices, faces) for faces in old))
    after = np.minimum(*(quality(vertices, faces) for faces in new))
    middle: Floats = np.add(*(face_crosses(vertices, faces) for faces in old))
    turn = np.minimum(*(_cosine(face_crosses(vertices, faces), middle) for faces in new))
    gain: Floats = np.where((turn > LARGEST_TURN) & (c != d), after - before, -1.0)
    return gain, pair, np.column_stack((c, d)), np.column_stack((a, b))


def _cosine(first: Floats, second: Floats) -> Floats:
    product = np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
    cosine: Floats = np.divide(np.einsum("ij,ij->i", first, second), product, out=np.full(len(first), -1.0), where=product > 0.0)
    return cosine


def _smooth(vertices: Floats, band: Faces, rim_count: int, draw: Callable[[Floats], Floats]) -> Floats:
    """Move each new vertex to the middle of its neighbours and onto the surface, unless a face becomes bad or turns over."""
    if len(vertices) == rim_count:
        return vertices
    rings = vertex_neighbours(edges(band).ends, len(vertices))
    stars = vertex_faces(band, len(vertices))
    wanted = draw(np.array([vertices[rings[vertex]].mean(axis=0) for vertex in range(rim_count, len(vertices))]))
    vertices = vertices.copy()
    for vertex, target in enumerate(wanted, start=rim_count):
        star = band[stars[vertex]]
        place = vertices[vertex].copy()
        before, looked = quality(vertices, star).min(), face_crosses(vertices, star)
        vertices[vertex] = target
        turned = _cosine(face_crosses(vertices, star), looked).min() < LARGEST_TURN
        if turned or quality(vertices, star).min() < min(before, GOOD):
            vertices[vertex] = place
    return vertices
