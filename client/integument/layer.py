"""A layer in the form the server takes."""

from __future__ import annotations

from typing import Any, Literal


def as_layer(name: str, depth: float | str, side: Literal["inside", "outside"] = "inside") -> dict[str, Any]:
    """depth: distance to the skin in mm, or the name of an array of the skin's upload with the distance at each vertex."""
    layer: dict[str, Any] = {"name": name}
    layer["depth_array" if isinstance(depth, str) else "depth_mm"] = depth
    if side != "inside":
        layer["side"] = side
    return layer
