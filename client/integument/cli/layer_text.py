"""Layers and regions as they are typed: `fat=1.0` and `name:xmin,ymin,zmin:xmax,ymax,zmax:fat=0.3,average_body=0.6[:blend]`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from integument.errors import ArgumentError
from integument.region import Point, Region

REGION_FORM = "name:xmin,ymin,zmin:xmax,ymax,zmax:layer=depth[,layer=depth][:blend]"
BOX_FORM = "name:xmin,ymin,zmin:xmax,ymax,zmax"


def read_layers(texts: Iterable[str], option: str = "--layer") -> dict[str, float]:
    """Name -> depth in mm, in the order given. Raises: ArgumentError."""
    layers: dict[str, float] = {}
    for text in texts:
        name, depth_mm = _read_depth(text, f"{option} {text}")
        if name in layers:
            raise ArgumentError(f"{option} {text}: the layer '{name}' is there already")
        layers[name] = depth_mm
    return layers


def read_region(text: str) -> Region:
    """Raises: ArgumentError that shows the form."""
    parts = text.split(":")
    where = f"--region {text}"
    if len(parts) not in (4, 5) or not parts[0]:
        raise ArgumentError(f"{where}: wanted is {REGION_FORM}")
    depths = dict(_read_depth(item, where) for item in parts[3].split(","))
    blend = _read_number(parts[4], where) if len(parts) == 5 else None
    return Region(parts[0], _read_point(parts[1], where), _read_point(parts[2], where), depths, blend)


def read_box(text: str, option: str = "--region") -> dict[str, Any]:
    """A region without depths, in the form the server takes. Raises: ArgumentError that shows the form."""
    parts = text.split(":")
    where = f"{option} {text}"
    if len(parts) != 3 or not parts[0]:
        raise ArgumentError(f"{where}: wanted is {BOX_FORM}")
    low, high = (_read_point(part, where) for part in parts[1:])
    return {"name": parts[0], "box_mm": {"min": list(low), "max": list(high)}}


def _read_depth(text: str, where: str) -> tuple[str, float]:
    name, sign, depth = text.partition("=")
    if not name or not sign:
        raise ArgumentError(f"{where}: wanted is layer=depth in mm, as fat=1.0")
    return name, _read_number(depth, where)


def _read_point(text: str, where: str) -> Point:
    numbers = [_read_number(item, where) for item in text.split(",")]
    if len(numbers) != 3:
        raise ArgumentError(f"{where}: '{text}' is no corner x,y,z in mm")
    return numbers[0], numbers[1], numbers[2]


def _read_number(text: str, where: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise ArgumentError(f"{where}: '{text}' is no number") from error
