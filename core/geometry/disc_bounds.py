"""Flat discs around the nodes of a face tree: on smooth surfaces far tighter than boxes, which a tilted patch fills badly."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.face_tree import FaceTree

Floats = NDArray[np.float64]

SAFETY = 1e-12  # of the largest coordinate: discs are grown by it, so that rounding never makes one too small


def disc_bounds(tree: FaceTree) -> Floats:
    """Discs of all nodes, (2 leaves - 1, 8) mm: centre x y z, unit axis x y z, radius, half thickness.

    Every point of a node's faces lies within its disc: at most the radius from the axis, at most half the thickness from
    the middle plane. The axis is the mean normal; parents enclose their children's discs.
    """
    discs = np.zeros((2 * tree.leaves - 1, 8))
    _fill_leaves(tree.corners, tree.leaves, discs)
    _fill_parents(tree.leaves, discs)
    discs[:, 6:] += SAFETY * max(1.0, float(np.abs(tree.boxes[0]).max()))
    return discs


@njit(cache=True, nogil=True)
def _set_axis(discs: Floats, node: int, x: float, y: float, z: float) -> None:
    """Unit axis along (x, y, z); any will do where normals cancel out."""
    length = math.sqrt(x * x + y * y + z * z)
    if length > 0.0:
        discs[node, 3], discs[node, 4], discs[node, 5] = x / length, y / length, z / length
    else:
        discs[node, 3], discs[node, 4], discs[node, 5] = 1.0, 0.0, 0.0


@njit(cache=True, nogil=True)
def _enclose(discs: Floats, node: int, x: float, y: float, z: float, radius: float, reach: float, span: Floats) -> None:
    """Grow the disc of a node by something around a place: `radius` wide in all directions, `reach` high along the axis.

    span (2,): lowest and highest so far, along the axis from the centre.
    """
    x, y, z = x - discs[node, 0], y - discs[node, 1], z - discs[node, 2]
    height = x * discs[node, 3] + y * discs[node, 4] + z * discs[node, 5]
    lateral = math.sqrt(max(x * x + y * y + z * z - height * height, 0.0))
    discs[node, 6] = max(discs[node, 6], lateral + radius)
    span[0], span[1] = min(span[0], height - reach), max(span[1], height + reach)


@njit(cache=True, nogil=True)
def _settle(discs: Floats, node: int, span: Floats) -> None:
    """Move the centre along the axis to the middle of the span, which is then done with."""
    middle = 0.5 * (span[0] + span[1])
    for axis in range(3):
        discs[node, axis] += middle * discs[node, axis + 3]
    discs[node, 7] = 0.5 * (span[1] - span[0])
    span[0], span[1] = np.inf, -np.inf


@njit(cache=True, nogil=True)
def _fill_leaves(corners: Floats, leaves: int, discs: Floats) -> None:
    """Discs around the faces of each leaf; discs must be zero."""
    span = np.array([np.inf, -np.inf])
    for leaf in range(leaves):
        node, first, last = leaves - 1 + leaf, leaf * len(corners) // leaves, (leaf + 1) * len(corners) // leaves
        x, y, z = 0.0, 0.0, 0.0
        for face in range(first, last):
            for axis in range(3):
                middle = (corners[face, 0, axis] + corners[face, 1, axis] + corners[face, 2, axis]) / 3.0
                discs[node, axis] += middle / (last - first)
            ux, uy = corners[face, 1, 0] - corners[face, 0, 0], corners[face, 1, 1] - corners[face, 0, 1]
            vx, vy = corners[face, 2, 0] - corners[face, 0, 0], corners[face, 2, 1] - corners[face, 0, 1]
            uz, vz = corners[face, 1, 2] - corners[face, 0, 2], corners[face, 2, 2] - corners[face, 0, 2]
            x, y, z = x + uy * vz - uz * vy, y + uz * vx - ux * vz, z + ux * vy - uy * vx
        _set_axis(discs, node, x, y, z)
        for face in range(first, last):
            for corner in range(3):
                _enclose(
                    discs, node, corners[face, corner, 0], corners[face, corner, 1], corners[face, corner, 2], 0.0, 0.0, span
                )
        _settle(discs, node, span)


@njit(cache=True, nogil=True)
def _fill_parents(leaves: int, discs: Floats) -> None:
    """Discs around the discs of both children, from the bottom up."""
    span = np.array([np.inf, -np.inf])
    for node in range(leaves - 2, -1, -1):
        left, right = 2 * node + 1, 2 * node + 2
        # children's axes may point opposite ways on the two sides of a sheet: the mean line counts, not the direction
        turn = discs[left, 3] * discs[right, 3] + discs[left, 4] * discs[right, 4] + discs[left, 5] * discs[right, 5]
        sign = 1.0 if turn >= 0.0 else -1.0
        for axis in range(3):
            discs[node, axis] = 0.5 * (discs[left, axis] + discs[right, axis])
        x, y, z = (
            discs[left, 3] + sign * discs[right, 3],
            discs[left, 4] + sign * discs[right, 4],
            discs[left, 5] + sign * discs[right, 5],
        )
        _set_axis(discs, node, x, y, z)
        for child in (left, right):
            cosine = discs[node, 3] * discs[child, 3] + discs[node, 4] * discs[child, 4] + discs[node, 5] * discs[child, 5]
            cosine = min(abs(cosine), 1.0)
            radius, thickness = discs[child, 6], discs[child, 7]
            reach = radius * math.sqrt(1.0 - cosine * cosine) + thickness * cosine
            around = math.sqrt(radius * radius + thickness * thickness)
            _enclose(discs, node, discs[child, 0], discs[child, 1], discs[child, 2], around, reach, span)
        _settle(discs, node, span)


@njit(cache=True, nogil=True)
def between_discs(discs_a: Floats, a: int, discs_b: Floats, b: int) -> float:
    """Lower bound of the squared distance between what two discs hold, seen along the axis of a."""
    wx, wy, wz = discs_b[b, 0] - discs_a[a, 0], discs_b[b, 1] - discs_a[a, 1], discs_b[b, 2] - discs_a[a, 2]
    nx, ny, nz = discs_a[a, 3], discs_a[a, 4], discs_a[a, 5]
    radius, thickness = discs_b[b, 6], discs_b[b, 7]
    height = abs(wx * nx + wy * ny + wz * nz)
    cosine = min(abs(nx * discs_b[b, 3] + ny * discs_b[b, 4] + nz * discs_b[b, 5]), 1.0)
    above = height - discs_a[a, 7] - radius * math.sqrt(1.0 - cosine * cosine) - thickness * cosine
    beside = math.sqrt(max(wx * wx + wy * wy + wz * wz - height * height, 0.0)) - discs_a[a, 6]
    beside -= math.sqrt(radius * radius + thickness * thickness)
    squared = 0.0
    if above > 0.0:
        squared += above * above
    if beside > 0.0:
        squared += beside * beside
    return squared
