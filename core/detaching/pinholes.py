"""Places where a slab and the skin meet in a ring too small to be meant."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.components import face_components, label_connected
from core.geometry.cut_surface import SKIN, CutSurface, euler_characteristic

Ints = NDArray[np.int64]


def count_tunnels(cut: CutSurface, end: int) -> int:
    """Walls around an end of a slit that are no discs: there the slab's edge runs through a fold of the skin and out again.

    end: the piece that is the slab's edge."""
    walls = cut.mesh.faces[cut.piece != SKIN]
    piece = cut.piece[cut.piece != SKIN]
    count, label = face_components(edges(walls))
    ending = np.unique(label[piece == end])
    return int(sum(euler_characteristic(walls[label == part]) != 1 for part in ending if count))


def count_pinholes(cut: CutSurface, smallest_mm: float) -> int:
    """Rings of the seam between walls and skin that no side of is as long as smallest_mm.

    The skin touches a wall from behind there: the cut leaves a tunnel as thin as a hair, which is closed and manifold, and a
    handle that the body has not."""
    net = edges(cut.mesh.faces)
    edge, pair, _side = net.two_faces()
    owner = cut.piece[pair]
    seam = net.ends[edge[(owner == SKIN).sum(axis=1) == 1]]
    corners, numbered = np.unique(seam, return_inverse=True)
    first, second = numbered.reshape(-1, 2).T
    count, ring = label_connected(len(corners), first, second)
    places = cut.mesh.vertices[corners]
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, ring, places)
    np.maximum.at(high, ring, places)
    return int(((high - low).max(axis=1) < smallest_mm).sum())
