"""Depths that come with the skin, one per vertex: what an algorithm may ask of them."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.mesh import Vertices
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.schema.shells import LARGEST_DEPTH_MM, Layer

Floats = NDArray[np.float64]


def require_depths(layer: Layer, arrays: Mapping[str, Floats], vertices: Vertices) -> Floats:
    """The depths of a layer at each vertex, (V,) mm.

    Raises: InputError `layer.array_missing`, `layer.array_out_of_range` with the vertices.
    """
    depths = arrays.get(str(layer.depth_array))
    if depths is None:
        held = ", ".join(sorted(arrays)) or "none"
        raise InputError(
            "layer.array_missing",
            f"layer '{layer.name}' asks for the array '{layer.depth_array}', but the skin's upload has none of that name with "
            f"one real number per vertex; it has: {held}",
            layer=layer.name,
            array=str(layer.depth_array),
        )
    wrong = ~((depths > 0) & (depths <= LARGEST_DEPTH_MM))  # NaN compares as false
    if wrong.any():
        first = int(np.flatnonzero(wrong)[0])
        told = (
            f"{int(wrong.sum())} of {len(depths)} values of '{layer.depth_array}' are no depths above 0 and up to "
            f"{LARGEST_DEPTH_MM:g} mm, the first is {depths[first]:g} at vertex {first} (from 0)"
        )
        raise _refused("layer.array_out_of_range", told, wrong, vertices, layer=layer.name)
    return depths


def require_inwards(layers: tuple[Layer, ...], depths_mm: Floats, vertices: Vertices) -> None:
    """Depths (L, V) must increase inwards at every vertex, from the outermost layer through the skin to the deepest.

    Raises: InputError `layer.depths_out_of_order` with the vertices.
    """
    inwards = np.array([[layer.signed(1.0)] for layer in layers]) * depths_mm
    for row, (outer, inner) in enumerate(pairwise(layers)):
        wrong = inwards[row + 1] <= inwards[row]
        if wrong.any():
            first = int(np.flatnonzero(wrong)[0])
            told = (
                f"layer '{inner.name}' does not lie inside layer '{outer.name}' at {int(wrong.sum())} of {len(vertices)} "
                f"vertices; at vertex {first} (from 0) {depths_mm[row + 1, first]:g} and {depths_mm[row, first]:g} mm are asked"
            )
            raise _refused("layer.depths_out_of_order", told, wrong, vertices, outer=outer.name, inner=inner.name)


def _refused(code: str, told: str, wrong: NDArray[np.bool_], vertices: Vertices, **facts: str) -> InputError:
    numbers = np.flatnonzero(wrong)[:MAX_PLACES]
    places = tuple(
        Place(mesh="skin", point_mm=(float(x), float(y), float(z)), vertices=(int(number),))
        for number, (x, y, z) in zip(numbers, vertices[numbers], strict=True)
    )
    count = int(wrong.sum())
    finding = Finding(code=code, severity=Severity.ERROR, message=told, count=count, places=places)
    error = InputError(code, told, findings=(finding,), count=count)
    error.facts.update(facts)
    return error
