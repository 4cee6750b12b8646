"""Layers and regions as they are typed: `fat=1.0` and `name:xmin,ymin,zmin:xmax,ymax,zmax:fat=0.3,average_body=0.6[:blend]`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import isfinite
from typing import Any, TypeVar

from integument.errors import ArgumentError
from integument.layer import as_layer
from integument.region import Point, Region

Depth = TypeVar("Depth", float, float | str, int, str | None, str)
NO_NUMBERS = ("nan", "inf", "infinity")  # words for numbers, not names of arrays

REGION_FORM = "name:xmin,ymin,zmin:xmax,ymax,zmax:layer=depth[,layer=depth][:blend]"
BOX_FORM = "name:xmin,ymin,zmin:xmax,ymax,zmax"
CONTACT_FORM = "name:xmin,ymin,zmin:xmax,ymax,zmax[:contacts]"
RATIO_FORM = "name:xmin,ymin,zmin:xmax,ymax,zmax:ratio"


def read_layers(outer: Iterable[str], inner: Iterable[str]) -> list[dict[str, Any]]:
    """The layers from outside inwards, in the form the server takes. Raises: ArgumentError."""
    return [
        *(as_layer(name, depth, "outside") for name, depth in _read_named(outer, "--outer-layer", _read_depth_or_array).items()),
        *(as_layer(name, depth) for name, depth in _read_named(inner, "--layer", _read_depth_or_array).items()),
    ]


def read_depths(texts: Iterable[str], option: str) -> dict[str, float]:
    """Layer -> depth in mm, in the order given. Raises: ArgumentError."""
    return _read_named(texts, option, _read_depth)


def read_ratio_region(text: str) -> dict[str, Any]:
    """A region with the share of its faces that stays, as the server takes it. Raises: ArgumentError that shows the form."""
    where = f"--region {text}"
    box, sign, ratio = text.rpartition(":")
    if not sign or box.count(":") != 2:
        raise ArgumentError(f"{where}: wanted is {RATIO_FORM}")
    return {**read_box(box), "ratio": _read_number(ratio, where)}


def read_contact_region(text: str) -> dict[str, Any]:
    """A region with its number of contacts, one if none is said, as the server takes it. Raises: ArgumentError."""
    where = f"--region {text}"
    if text.count(":") != 3:
        return read_box(text)
    box, _sign, contacts = text.rpartition(":")
    if not (contacts.isascii() and contacts.isdigit()):
        raise ArgumentError(f"{where}: wanted is {CONTACT_FORM}")
    return {**read_box(box), "contacts": int(contacts)}


def read_volumes(texts: Iterable[str]) -> dict[str, float]:
    """Tissue -> largest tetrahedron in mm³. Raises: ArgumentError."""
    return _read_named(texts, "--max-volume", _read_depth)


def read_label_names(texts: Iterable[str]) -> dict[str, str]:
    """Label -> name of its surface, as the server takes it. Raises: ArgumentError."""
    return _read_named(texts, "--name", _read_label)


def read_priorities(texts: Iterable[str]) -> dict[str, int]:
    """Tissue -> whole number. Raises: ArgumentError."""
    return _read_named(texts, "--priority", _read_whole)


def read_inside(texts: Iterable[str]) -> dict[str, str | None]:
    """Tissue -> the one that holds it, None for none. Raises: ArgumentError."""
    return _read_named(texts, "--inside", _read_holder)


def _read_named(texts: Iterable[str], option: str, read: Callable[[str, str], tuple[str, Depth]]) -> dict[str, Depth]:
    layers: dict[str, Depth] = {}
    for text in texts:
        name, depth = read(text, f"{option} {text}")
        if name in layers:
            raise ArgumentError(f"{option} {text}: the layer '{name}' is there already")
        layers[name] = depth
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


def _read_whole(text: str, where: str) -> tuple[str, int]:
    name, _sign, number = text.partition("=")
    try:
        return name, int(number)
    except ValueError:
        raise ArgumentError(f"{where}: wanted is name=number, a whole one, as skin=1") from None


def _read_label(text: str, where: str) -> tuple[str, str]:
    label, _sign, name = text.partition("=")
    if not (label.isascii() and label.isdigit()) or not name:
        raise ArgumentError(f"{where}: wanted is label=name, as 2=white_matter")
    return str(int(label)), name


def _read_holder(text: str, where: str) -> tuple[str, str | None]:
    name, sign, holder = text.partition("=")
    if not name or not sign:
        raise ArgumentError(f"{where}: wanted is inner=outer, as white=grey, or inner= if nothing holds it")
    return name, holder or None


def _read_depth(text: str, where: str) -> tuple[str, float]:
    name, sign, depth = text.partition("=")
    if not name or not sign:
        raise ArgumentError(f"{where}: wanted is layer=depth in mm, as fat=1.0")
    return name, _read_number(depth, where)


def _read_depth_or_array(text: str, where: str) -> tuple[str, float | str]:
    """What begins with a letter is the name of an array of the skin's upload."""
    name, sign, depth = text.partition("=")
    if sign and name and depth[:1].isalpha() and depth.lower() not in NO_NUMBERS:
        return name, depth
    return _read_depth(text, where)


def _read_point(text: str, where: str) -> Point:
    numbers = [_read_number(item, where) for item in text.split(",")]
    if len(numbers) != 3:
        raise ArgumentError(f"{where}: '{text}' is no corner x,y,z in mm")
    return numbers[0], numbers[1], numbers[2]


def _read_number(text: str, where: str) -> float:
    try:
        number = float(text)
    except ValueError as error:
        raise ArgumentError(f"{where}: '{text}' is no number") from error
    if not isfinite(number):
        raise ArgumentError(f"{where}: '{text}' is no finite number")
    return number
