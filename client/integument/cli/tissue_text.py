"""Inner tissues as they are typed: `heart=heart.stl`, `white=grey`, `heart=0.4`."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite

from integument.errors import ArgumentError


def read_pairs(texts: Iterable[str], option: str, form: str) -> dict[str, str]:
    """Name -> what stands behind the first `=`, in the order given. Raises: ArgumentError that shows the form."""
    pairs: dict[str, str] = {}
    for text in texts:
        name, _sign, value = text.partition("=")
        if not name or not value:
            raise ArgumentError(f"{option} {text}: wanted is {form}")
        if name in pairs:
            raise ArgumentError(f"{option} {text}: '{name}' is there already")
        pairs[name] = value
    return pairs


def read_conductivities(texts: Iterable[str]) -> dict[str, float]:
    """Tissue -> S/m. Raises: ArgumentError."""
    conductivities = {}
    for name, value in read_pairs(texts, "--conductivity", "NAME=S/M").items():
        try:
            conductivities[name] = float(value)
        except ValueError:
            raise ArgumentError(f"--conductivity {name}={value}: '{value}' is no number") from None
        if not isfinite(conductivities[name]):
            raise ArgumentError(f"--conductivity {name}={value}: '{value}' is no finite number")
    return conductivities
