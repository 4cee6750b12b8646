"""Coils in SimNIBS' JSON format, .tcd: millimetres and A·m². Written here."""

from __future__ import annotations

import base64
import binascii
import json
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.coil import Coil
from core.errors import InputError, LimitError
from core.io.naming import clean_name
from core.schema.finding import Finding, Severity

EXTENSION = ".tcd"
DIPOLES, WIRE, SAMPLED = 1, 2, 3  # types of elements
MOST_BYTES = 256_000_000  # JSON takes some ten times as much once it is read
MOST_ROWS = 5_000_000

Floats = NDArray[np.float64]


def read_tcd(path: Path) -> tuple[Coil, tuple[Finding, ...]]:
    """Dipoles and pieces of wire of all elements, undeformed. Vector potentials on grids are left out: they have no place.

    Arrays are lists, or base64 of deflated doubles. Nothing is unpickled.
    Raises: InputError `coil.corrupt`, and those of `Coil.of`; LimitError `coil.too_large`.
    """
    elements = _elements(path)
    parts: dict[int, list[tuple[Floats, Floats]]] = {DIPOLES: [], WIRE: []}
    sampled = 0
    for number, element in enumerate(elements):
        type_ = element.get("type") if isinstance(element, dict) else None
        if type_ == SAMPLED:
            sampled += 1
        elif type_ in (DIPOLES, WIRE):
            parts[type_].append(_rows(element, number, type_))
        else:
            raise _corrupt(f"element {number} is of type {clean_name(repr(type_))[:40]}; 1, 2 and 3 are known")
    stacked = [np.concatenate([np.empty((0, 3)), *(pair[side] for pair in parts[type_])]) for type_ in parts for side in (0, 1)]
    coil = Coil.of(*stacked)
    if not sampled:
        return coil, ()
    message = f"{sampled} elements are vector potentials on grids, which have no place to be drawn at; they were left out"
    return coil, (Finding(code="coil.element_left_out", severity=Severity.INFO, message=message, count=sampled),)


def _elements(path: Path) -> list[Any]:
    size = path.stat().st_size
    if size > MOST_BYTES:
        raise LimitError("coil.too_large", f"the file has {size} bytes, {MOST_BYTES} are read of a coil in JSON", bytes=size)
    try:
        told = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise _corrupt(f"it is no JSON: {clean_name(str(error))}") from error
    elements = told.get("coilElementList") if isinstance(told, dict) else None
    if not isinstance(elements, list):
        raise _corrupt("there is no list coilElementList")
    return elements


def _rows(element: dict[str, Any], number: int, type_: int) -> tuple[Floats, Floats]:
    """Places (N, 3) and values (N, 3). Wire without values runs from each point to the next and back to the first."""
    points = _matrix(element.get("points"), f"points of element {number}")
    if type_ == WIRE and element.get("values") is None:
        along = np.roll(points, -1, axis=0) - points
        return points + along / 2, along
    values = _matrix(element.get("values"), f"values of element {number}")
    if len(points) != len(values):
        raise InputError(
            "coil.count_mismatch",
            f"element {number} has {len(points)} points and {len(values)} values",
            announced=len(points),
            found=len(values),
        )
    return points, values


def _matrix(told: object, what: str) -> Floats:
    if isinstance(told, str):
        return _unpacked(told, what)
    try:
        rows = np.array(told, dtype=np.float64)
    except (ValueError, TypeError, OverflowError) as error:
        raise _corrupt(f"{what} are no rows of three numbers") from error
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise _corrupt(f"{what} have shape {rows.shape}; rows of three numbers are wanted")
    return rows


def _unpacked(text: str, what: str) -> Floats:
    unpacker = zlib.decompressobj()
    try:
        data = unpacker.decompress(base64.b64decode(text, validate=True), MOST_ROWS * 24 + 1)
    except (binascii.Error, zlib.error, ValueError) as error:
        raise _corrupt(f"{what} are neither lists nor base64 of deflated numbers") from error
    if len(data) > MOST_ROWS * 24:
        raise LimitError("coil.too_large", f"{what} are more than the {MOST_ROWS} that are read", most=MOST_ROWS)
    if not data or len(data) % 24:
        raise _corrupt(f"{what} have {len(data)} bytes, no multiple of the 24 of three doubles")
    return np.frombuffer(data, "<f8").reshape(-1, 3)


def _corrupt(reason: str) -> InputError:
    return InputError("coil.corrupt", f"the .tcd file cannot be read: {reason}")
