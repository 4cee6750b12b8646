"""Where each method would send the vertices in one simultaneous step, before anything is checked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.connectivity import Connectivity
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.laplacian import laplacian_step, neighbour_means, taubin_step
from core.geometry.normals import face_crosses, normalised
from core.mesh import Vertices
from core.schema.smooth import SmoothInputs
from core.smoothing.star_centres import centroid_centres, circumcentre_centres

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CENTRES = {"cvt": centroid_centres, "wcc": circumcentre_centres}


@dataclass(frozen=True, eq=False, slots=True)
class Original:
    """The surface before the first step: vertices (V, 3) mm and its faces in space."""

    vertices: Vertices
    tree: FaceTree


def propose(vertices: Vertices, original: Original, net: Connectivity, chosen: Ints, inputs: SmoothInputs) -> Vertices:
    """New places of all vertices, (V, 3) mm, from the places now; the not chosen stay.

    chosen: (K,) vertices with a whole fan of faces.
    """
    match inputs.method:
        case "standard":
            proposal = laplacian_step(vertices, net.neighbours, chosen, inputs.weight)
        case "lumped":
            proposal = laplacian_step(vertices, net.neighbours, chosen, 2.0 / 3.0 * inputs.weight)
        case "cvt" | "wcc":
            proposal = vertices.copy()
            centres = CENTRES[inputs.method](vertices, net.faces, net.faces_around, chosen, equal=inputs.equal_weights)
            proposal[chosen] += inputs.weight * (centres - vertices[chosen])
        case "hc":
            proposal = humphrey_step(vertices, original.vertices, net, chosen, inputs.hc_alpha, inputs.hc_beta)
        case "taubin":
            proposal = taubin_step(vertices, net.neighbours, chosen, inputs.taubin_lambda, inputs.taubin_mu)
    if inputs.along_surface:
        _drop_normal_part(vertices, proposal, net, chosen)
        proposal[chosen] = closest_points_in(original.tree, proposal[chosen])[1]
    if inputs.max_shift_mm is not None:
        _hold_near(original.vertices, proposal, chosen, inputs.max_shift_mm)
    return proposal


def humphrey_step(vertices: Vertices, original: Vertices, net: Connectivity, chosen: Ints, alpha: float, beta: float) -> Vertices:
    """Standard Laplacian step, then pushed back by what it moved: own share β, the rest the neighbours'; (V, 3) mm.

    b = p* - (α o + (1 - α) p) for the original places o and those before the step p; p* -= β b + (1 - β) mean of the
    neighbours' b. A vertex that is not chosen does not move and has b = 0.
    Source: Vollmer, Mencl & Müller 1999, doi:10.1111/1467-8659.00334, the simultaneous version.
    """
    stepped = laplacian_step(vertices, net.neighbours, chosen, 1.0)
    push = np.zeros_like(vertices)
    push[chosen] = stepped[chosen] - (alpha * original[chosen] + (1.0 - alpha) * vertices[chosen])
    stepped[chosen] -= beta * push[chosen] + (1.0 - beta) * neighbour_means(push, net.neighbours, chosen)
    return stepped


def _drop_normal_part(vertices: Vertices, proposal: Vertices, net: Connectivity, chosen: Ints) -> None:
    """Take out of the moves, in place, what leads along the normal of the faces around (weighted by area)."""
    crosses = face_crosses(vertices, net.faces)
    normals: Floats = np.empty_like(vertices)
    for axis in range(3):
        normals[:, axis] = np.bincount(net.faces.ravel(), np.repeat(crosses[:, axis], 3), len(vertices))
    units = normalised(normals[chosen])
    moves = proposal[chosen] - vertices[chosen]
    proposal[chosen] -= np.einsum("ij,ij->i", moves, units)[:, None] * units


def _hold_near(original: Vertices, proposal: Vertices, chosen: Ints, most_mm: float) -> None:
    """Bring back, in place, what lies farther than `most_mm` from its original place, straight towards it."""
    # rounding to float32 adds at most one of its steps
    most_mm = max(most_mm - float(np.spacing(np.float32(np.abs(original).max()))), 0.0)
    way = proposal[chosen] - original[chosen]
    length = np.linalg.norm(way, axis=1)
    far = length > most_mm
    proposal[chosen[far]] = original[chosen[far]] + (most_mm / length[far])[:, None] * way[far]
