"""The skin around a contact, told apart into what belongs to one part and to the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.detaching.creases import valley_shares
from core.detaching.graph_cut import SINK, SOURCE, cut_in_two
from core.detaching.region_grid import RegionGrid
from core.detaching.surface_nets import sample
from core.geometry.adjacency import edges
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SURE_CUBES = 2.5  # from the cut in the grid: farther faces are known to belong to its side
UNITS = 1e3  # costs are whole numbers


def label_faces(mesh: Mesh, chosen: Ints, grid: RegionGrid, towards: Floats) -> NDArray[np.int8]:
    """1 or 2 for each of the chosen faces (N,): the part it belongs to. towards: (X, Y, Z) mm, positive in part 1.

    Near the cut the line between the parts is the one that costs least where valleys are cheap, so it follows the crease."""
    corners = mesh.triangles()[chosen]
    value = sample(towards, corners.mean(axis=1) - grid.low_mm, grid.size_mm)
    sure = np.abs(value) > SURE_CUBES * grid.size_mm
    number = 2 + np.arange(len(chosen))
    number[sure] = np.where(value[sure] > 0.0, SOURCE, SINK)
    net = edges(mesh.faces[chosen])
    edge, pair, side = net.two_faces()
    cost = _costs(mesh, chosen, pair, net.ends[edge], side)
    reached = cut_in_two(2 + len(chosen), number[pair[:, 0]], number[pair[:, 1]], cost)
    return np.where(reached[number], 1, 2).astype(np.int8)


def _costs(mesh: Mesh, chosen: Ints, pair: Ints, ends: Ints, side: Ints) -> Ints:
    """Length of each edge, nothing nearly in valleys; (E,) whole numbers above 0."""
    length = np.linalg.norm(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]], axis=1)
    share = valley_shares(mesh, chosen, pair, ends, side)
    costs: Ints = np.maximum((length * share * UNITS).astype(np.int64), 1)
    return costs
