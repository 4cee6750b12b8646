"""Regions are told apart by their names, in findings and reports."""

from __future__ import annotations

from collections.abc import Sequence


def require_different_names(names: Sequence[str]) -> None:
    """Raises: ValueError if two are the same."""
    if len(set(names)) != len(names):
        raise ValueError(f"regions must have different names: {list(names)}")
