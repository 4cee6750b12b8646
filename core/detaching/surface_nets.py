"""The zero level of a field on a grid as triangles of nearly one size."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def sample(field: Floats, places: Floats, size: float) -> Floats:
    """Values (N,) between the middles of cubes, linear; places (N, 3) mm from the low corner of the grid."""
    values: Floats = map_coordinates(field, (places / size - 0.5).T, order=1, mode="nearest")
    return values


def draw_zero_level(field: Floats, size: float, edge: float) -> tuple[Floats, Ints]:
    """Vertices (V, 3) mm from the low corner and faces (F, 3), looking to where the field grows.

    One vertex per cube of side `edge` that the level runs through, at the mean of its crossings with the cube's sides; two
    triangles around each side crossed. Source: naive surface nets (Gibson 1998, doi:10.1007/BFb0056277)."""
    extents = np.array(field.shape) * size
    counts = np.maximum(np.floor(extents / edge).astype(np.int64), 1) + 1
    lattice = np.stack(np.meshgrid(*(np.arange(count) for count in counts), indexing="ij"), axis=-1)
    value = sample(field, lattice.reshape(-1, 3) * edge, size).reshape(lattice.shape[:3])
    value[value == 0.0] = 1e-9
    cells = counts - 1
    total, number = np.zeros((*cells, 3)), np.zeros(cells, dtype=np.int64)
    sides = [_crossed(value, axis) for axis in range(3)]
    for axis, nodes in enumerate(sides):
        along = np.eye(3, dtype=np.int64)[axis]
        low, high = value[tuple(nodes.T)], value[tuple((nodes + along).T)]
        crossing = (nodes + along * (low / (low - high))[:, None]) * edge
        for cell in _cells_around(nodes, axis):
            fits = ((cell >= 0) & (cell < cells)).all(axis=1)
            np.add.at(total, tuple(cell[fits].T), crossing[fits])
            np.add.at(number, tuple(cell[fits].T), 1)
    used = number > 0
    vertex = np.full(cells, -1, dtype=np.int64)
    vertex[used] = np.arange(int(used.sum()))
    faces = []
    for axis, nodes in enumerate(sides):
        around = np.stack(_cells_around(nodes, axis), axis=1)
        fits = ((around >= 0) & (around < cells)).all(axis=(1, 2))
        nodes, around = nodes[fits], around[fits]
        quad = vertex[around[..., 0], around[..., 1], around[..., 2]]
        grows = value[tuple((nodes + np.eye(3, dtype=np.int64)[axis]).T)] > 0.0
        quad[~grows] = quad[~grows][:, ::-1]
        faces.append(quad[:, [0, 1, 2]])
        faces.append(quad[:, [0, 2, 3]])
    return total[used] / number[used][:, None], np.concatenate(faces)


def _crossed(value: Floats, axis: int) -> Ints:
    """Lower nodes (N, 3) of lattice sides along an axis whose ends differ in sign."""
    low = [slice(None)] * 3
    high = [slice(None)] * 3
    low[axis], high[axis] = slice(None, -1), slice(1, None)
    return np.argwhere((value[tuple(low)] > 0.0) != (value[tuple(high)] > 0.0))


def _cells_around(nodes: Ints, axis: int) -> list[Ints]:
    """The four cells around each side, counter-clockwise seen from the end of the axis."""
    u, v = np.eye(3, dtype=np.int64)[[(axis + 1) % 3, (axis + 2) % 3]]
    return [nodes - u - v, nodes - v, nodes, nodes - u]
