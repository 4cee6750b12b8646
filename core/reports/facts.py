"""Facts of changes as people read them: `largest_shift_mm: 0.31234567` becomes *largest shift*, `0.3123 mm`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.reports.wording import NOT_KNOWN, drift, point, quantity

UNITS = {"_mm": "mm", "_mm2": "mm²", "_mm3": "mm³", "_cm2": "cm²", "_cm3": "cm³", "_deg": "°", "_percent": "%", "_s": "s"}
CHANGE = "_change"  # of area or volume, as a share


def fact_name(key: str) -> tuple[str, str]:
    """Words and unit of a key, either may be empty."""
    ending = max((ending for ending in UNITS if key.endswith(ending)), key=len, default="")
    return key.removesuffix(ending).replace("_", " "), UNITS.get(ending, "")


def heading(key: str) -> str:
    """Of a column: `distance_mm` -> `distance [mm]`, `fat.area_mm2` -> `fat area [mm²]`."""
    name, unit = fact_name(key)
    words = name.replace(".", " ")
    return f"{words} [{unit}]" if unit else words


def fact_value(key: str, value: Any) -> str:
    """Without its unit."""
    if value is None or value in ({}, [], ()):
        return NOT_KNOWN
    if isinstance(value, list | tuple):
        numbers = all(isinstance(each, float | int) for each in value)
        return point((value[0], value[1], value[2])) if numbers and len(value) == 3 else ", ".join(map(str, value))
    if key.endswith(CHANGE) and isinstance(value, float | int):
        return drift(value)
    return quantity(value) if isinstance(value, float | int) else str(value)


def facts_of(told: Mapping[str, Any], before: str = "") -> list[tuple[str, str]]:
    """(words, value with its unit) of every fact; those of nested objects have the object's words in front."""
    rows: list[tuple[str, str]] = []
    for key, value in told.items():
        name, unit = fact_name(key)
        if isinstance(value, Mapping) and value:
            rows += facts_of(value, f"{before}{name}, ")
        else:
            shown = fact_value(key, value)
            rows.append((f"{before}{name}", f"{shown} {unit}" if unit and shown != NOT_KNOWN else shown))
    return rows
