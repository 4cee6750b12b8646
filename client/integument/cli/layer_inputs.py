"""What `shells`, `ears` and `prepare` are asked alike: layers, boxes, depths in ears, gaps, conductivities."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integument.cli.layer_text import read_depths, read_layers, read_region
from integument.cli.tissue_text import read_conductivities

Texts = Sequence[str] | None


def read_layer_inputs(
    *,
    layer: Texts,
    outer_layer: Texts,
    thin_policy: str,
    min_gap: float | None,
    skin_shift: float | None,
    conductivity: Texts,
    region: Texts = None,
    ear_depth: Texts = None,
    blend: float | None = None,
    generate_canals: bool = False,
) -> dict[str, Any]:
    """Options as they were typed, in the form the server takes; what was not typed is left to it. Raises: ArgumentError."""
    inputs: dict[str, Any] = {"thin_policy": thin_policy}
    if layer or outer_layer:
        inputs["layers"] = read_layers(outer_layer or (), layer or ())
    if region:
        inputs["regions"] = [read_region(text).as_input() for text in region]
    if ear_depth:
        inputs["ear_depths_mm"] = read_depths(ear_depth, "--ear-depth")
    if conductivity:
        inputs["conductivities_s_per_m"] = read_conductivities(conductivity)
    if generate_canals:
        inputs["generate_canals"] = {}
    numbers = {"blend_mm": blend, "min_gap_mm": min_gap, "skin_shift_mm": skin_shift}
    return inputs | {name: value for name, value in numbers.items() if value is not None}
