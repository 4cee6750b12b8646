"""A tree of boxes over faces that change: cut once along a space-filling curve, widened where faces grow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.decimation.kernel import kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]

FACES_PER_LEAF = 8
STACK = 64  # a binary tree over 2^31 faces is not deeper
BITS = 21  # of each coordinate in the curve's number


def morton_order(centres: Floats) -> Ints:
    """Order of points (N, 3) along the Z curve (Morton 1966), ties by number."""
    low = centres.min(axis=0)
    size = float((centres.max(axis=0) - low).max())
    cells = ((centres - low) * ((2**BITS - 1) / size if size > 0.0 else 0.0)).astype(np.uint64)
    code = np.zeros(len(centres), dtype=np.uint64)
    for axis in range(3):
        code |= _spread(cells[:, axis]) << np.uint64(axis)
    return np.argsort(code, kind="stable")


def _spread(values: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Two zero bits behind every one of the 21 lowest bits."""
    for shift, mask in (
        (32, 0x1F00000000FFFF), (16, 0x1F0000FF0000FF), (8, 0x100F00F00F00F00F), (4, 0x10C30C30C30C30C3), (2, 0x1249249249249249),
    ):  # fmt: skip
        values = (values | (values << np.uint64(shift))) & np.uint64(mask)
    return values


def box_tree(points: Floats, faces: Int32s) -> Floats:
    """Boxes of a complete tree over faces (F, 3) in their order: (2 leaves - 1, 6), children of n are 2 n + 1 and 2 n + 2.

    Leaf k holds the faces from FACES_PER_LEAF k on.
    """
    leaves = 1
    while leaves * FACES_PER_LEAF < len(faces):
        leaves *= 2
    boxes = np.empty((2 * leaves - 1, 6))
    fit_boxes(points, faces.ravel(), boxes)
    return boxes


@kernel
def fit_boxes(points: Floats, ids: Int32s, boxes: Floats) -> None:
    """Boxes of all nodes as tight as can be; faces that are gone have negative ids."""
    leaves = (len(boxes) + 1) // 2
    boxes[:, :3] = np.inf
    boxes[:, 3:] = -np.inf
    for face in range(len(ids) // 3):
        if ids[3 * face] < 0:
            continue
        leaf = leaves - 1 + face // FACES_PER_LEAF
        for corner in range(3):
            for axis in range(3):
                value = points[ids[3 * face + corner], axis]
                boxes[leaf, axis] = min(boxes[leaf, axis], value)
                boxes[leaf, axis + 3] = max(boxes[leaf, axis + 3], value)
    for node in range(leaves - 2, -1, -1):
        for axis in range(3):
            boxes[node, axis] = min(boxes[2 * node + 1, axis], boxes[2 * node + 2, axis])
            boxes[node, axis + 3] = max(boxes[2 * node + 1, axis + 3], boxes[2 * node + 2, axis + 3])


@kernel
def widen(points: Floats, ids: Int32s, boxes: Floats, face: int) -> None:
    """Make the boxes above a face hold it; stops at the first that does already."""
    a, b, c = ids[3 * face], ids[3 * face + 1], ids[3 * face + 2]
    node = (len(boxes) + 1) // 2 - 1 + face // FACES_PER_LEAF
    x, y = min(points[a, 0], points[b, 0], points[c, 0]), min(points[a, 1], points[b, 1], points[c, 1])
    z = min(points[a, 2], points[b, 2], points[c, 2])
    u, v = max(points[a, 0], points[b, 0], points[c, 0]), max(points[a, 1], points[b, 1], points[c, 1])
    w = max(points[a, 2], points[b, 2], points[c, 2])
    while True:
        # no views of rows: each would count references
        low = boxes[node, 0] <= x and boxes[node, 1] <= y and boxes[node, 2] <= z
        if low and boxes[node, 3] >= u and boxes[node, 4] >= v and boxes[node, 5] >= w:
            return
        boxes[node, 0], boxes[node, 1] = min(boxes[node, 0], x), min(boxes[node, 1], y)
        boxes[node, 2], boxes[node, 3] = min(boxes[node, 2], z), max(boxes[node, 3], u)
        boxes[node, 4], boxes[node, 5] = max(boxes[node, 4], v), max(boxes[node, 5], w)
        if node == 0:
            return
        node = (node - 1) // 2


@kernel
def find_in_box(points: Floats, ids: Int32s, boxes: Floats, box: Floats, stack: Ints, found: Ints) -> int:
    """Faces whose boxes meet box (6,), into found; returns how many, or -1 if found is too short. stack: (STACK,) scratch."""
    leaves, faces, count = (len(boxes) + 1) // 2, len(ids) // 3, 0
    stack[0], top = 0, 1
    while top > 0:
        top -= 1
        node = stack[top]
        if boxes[node, 0] > box[3] or boxes[node, 1] > box[4] or boxes[node, 2] > box[5]:
            continue
        if boxes[node, 3] < box[0] or boxes[node, 4] < box[1] or boxes[node, 5] < box[2]:
            continue
        if node < leaves - 1:
            stack[top], stack[top + 1] = 2 * node + 2, 2 * node + 1
            top += 2
            continue
        first = (node - leaves + 1) * FACES_PER_LEAF
        for face in range(first, min(first + FACES_PER_LEAF, faces)):
            a = ids[3 * face]
            if a < 0:
                continue
            b, c = ids[3 * face + 1], ids[3 * face + 2]
            apart = False
            for axis in range(3):
                p, q, r = points[a, axis], points[b, axis], points[c, axis]
                if min(p, q, r) > box[axis + 3] or max(p, q, r) < box[axis]:
                    apart = True
                    break
            if apart:
                continue
            if count == len(found):
                return -1
            found[count] = face
            count += 1
    return count
