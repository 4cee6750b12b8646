"""Signs that are never wrong: on which side, and whether in one line or plane.

A float64 filter decides nearly all cases; the rest is computed in whole numbers, to which floats scale without loss.
Source: Shewchuk 1997, doi:10.1007/PL00009321 (error bounds of the filter).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Signs = NDArray[np.int8]

HALF_ULP = 2.0**-53
BOUND_2D = (3.0 + 16.0 * HALF_ULP) * HALF_ULP
BOUND_3D = (7.0 + 56.0 * HALF_ULP) * HALF_ULP
UNDERFLOW = 1e-290  # below it a product may have lost digits the bounds do not know of


def orient2d(a: Points, b: Points, c: Points) -> Signs:
    """Sign of the area of the plane triangles a, b, c, each (N, 2): 1 counter-clockwise, -1 clockwise, 0 in one line."""
    left = (a[:, 0] - c[:, 0]) * (b[:, 1] - c[:, 1])
    right = (a[:, 1] - c[:, 1]) * (b[:, 0] - c[:, 0])
    determinant = left - right
    signs = np.sign(determinant).astype(np.int8)
    unsure = np.flatnonzero(np.abs(determinant) <= BOUND_2D * (np.abs(left) + np.abs(right)) + UNDERFLOW)
    if len(unsure):
        whole = _whole_numbers(np.stack((a[unsure], b[unsure], c[unsure]), axis=1))
        u, v = whole[:, 0] - whole[:, 2], whole[:, 1] - whole[:, 2]
        signs[unsure] = _signs_of(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    return signs


def orient3d(a: Points, b: Points, c: Points, d: Points) -> Signs:
    """Side of the plane a, b, c on which d lies, each (N, 3).

    Returns (N,): 1 where a, b, c look counter-clockwise from d (d is above), -1 below, 0 in the plane.
    """
    u, v, w = a - d, b - d, c - d
    first, second = v[:, 0] * w[:, 1], w[:, 0] * v[:, 1]
    third, fourth = w[:, 0] * u[:, 1], u[:, 0] * w[:, 1]
    fifth, sixth = u[:, 0] * v[:, 1], v[:, 0] * u[:, 1]
    determinant = u[:, 2] * (first - second) + v[:, 2] * (third - fourth) + w[:, 2] * (fifth - sixth)
    permanent = (
        (np.abs(first) + np.abs(second)) * np.abs(u[:, 2])
        + (np.abs(third) + np.abs(fourth)) * np.abs(v[:, 2])
        + (np.abs(fifth) + np.abs(sixth)) * np.abs(w[:, 2])
    )
    signs = -np.sign(determinant).astype(np.int8)
    unsure = np.flatnonzero(np.abs(determinant) <= BOUND_3D * permanent + UNDERFLOW)
    if len(unsure):
        whole = _whole_numbers(np.stack((a[unsure], b[unsure], c[unsure], d[unsure]), axis=1))
        u, v, w = whole[:, 0] - whole[:, 3], whole[:, 1] - whole[:, 3], whole[:, 2] - whole[:, 3]
        exact = (
            u[:, 2] * (v[:, 0] * w[:, 1] - w[:, 0] * v[:, 1])
            + v[:, 2] * (w[:, 0] * u[:, 1] - u[:, 0] * w[:, 1])
            + w[:, 2] * (u[:, 0] * v[:, 1] - v[:, 0] * u[:, 1])
        )
        signs[unsure] = -_signs_of(exact)
    return signs


def are_collinear(a: Points, b: Points, c: Points) -> NDArray[np.bool_]:
    """True where three points (N, 3) lie in one line or at one place: the triangle has no area."""
    flat = np.ones(len(a), dtype=bool)
    for plane in ([0, 1], [1, 2], [2, 0]):
        rest = np.flatnonzero(flat)
        flat[rest] = orient2d(a[rest][:, plane], b[rest][:, plane], c[rest][:, plane]) == 0
    return flat


def _whole_numbers(points: NDArray[np.float64]) -> NDArray[np.object_]:
    """Coordinates (N, ...) times one power of two per row, as Python integers of any size."""
    mantissa, exponent = np.frexp(points)
    rows = (len(points), -1)
    # a zero has no exponent of its own
    smallest = np.where(mantissa == 0.0, np.iinfo(np.int32).max, exponent).reshape(rows).min(axis=1)
    smallest = smallest.reshape((-1,) + (1,) * (points.ndim - 1))
    shift = np.where(mantissa == 0.0, 0, exponent - smallest)
    whole: NDArray[np.object_] = np.left_shift((mantissa * 2.0**53).astype(np.int64).astype(object), shift.astype(object))
    return whole


def _signs_of(values: NDArray[np.object_]) -> Signs:
    """Signs of Python integers (N,)."""
    return (values > 0).astype(np.int8) - (values < 0).astype(np.int8)
