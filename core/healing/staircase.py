"""The steps of surfaces made from voxels, smoothed away."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges, vertex_neighbours
from core.geometry.connectivity import Connectivity
from core.geometry.degenerate import find_degenerate_faces
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.laplacian import taubin_step
from core.healing.change import Change, Staged
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]

ITERATIONS = 20  # pairs of a shrinking and a growing step: beyond it steps of voxels are gone and features begin to go
SHRINK = 0.5
GROW = -0.53
RETREATS = 8  # halvings of the way where the surface would meet itself; then it stays as it was there


def smooth_steps(vertices: Vertices, faces: Faces, max_mm: float) -> Staged:
    """Low-pass filter of a surface; no vertex moves farther than max_mm, and where the surface would meet itself it stays.

    Needs a closed surface free of self-intersection. Source: Taubin 1995, doi:10.1145/218380.218473.
    """
    rings, everywhere = vertex_neighbours(edges(faces).ends, len(vertices)), np.arange(len(vertices))
    places = vertices
    for _ in range(ITERATIONS):
        places = _within(vertices, taubin_step(places, rings, everywhere, SHRINK, GROW), max_mm)
    net = Connectivity.of(faces, len(vertices))
    share = np.ones(len(vertices))
    for last in range(RETREATS, -1, -1):
        moved = vertices + share[:, None] * (places - vertices)
        moved = moved.astype(np.float32).astype(np.float64)
        bad = np.union1d(find_intersecting_faces(moved, faces).ravel(), find_degenerate_faces(moved, faces))
        if len(bad) == 0:
            break
        near = net.grown(net.grown(net.corners_of(bad.astype(np.int64))))
        share[near] *= 0.5 if last > 1 else 0.0
    else:
        return vertices, faces, []
    distances = np.linalg.norm(moved - vertices, axis=1)
    changed = np.flatnonzero(distances > 0.0)
    if len(changed) == 0:
        return vertices, faces, []
    message = f"steps were smoothed: {len(changed)} vertices moved, by {distances.max():.3g} mm at most"
    return moved, faces, [Change("staircase", message, vertices[changed], distances[changed])]


def _within(vertices: Vertices, places: Floats, max_mm: float) -> Floats:
    """Places no farther than max_mm from the vertices."""
    way = places - vertices
    length = np.linalg.norm(way, axis=1)
    # a little less, for the rounding that follows
    factor = np.minimum(1.0, 0.999 * max_mm / np.maximum(length, 1e-300))
    bounded: Floats = vertices + way * factor[:, None]
    return bounded
