"""Why a contact cannot be opened, with places."""

from __future__ import annotations

from collections.abc import Sequence

from core.schema.finding import MAX_PLACES, Finding, Place, Severity

Point = tuple[float, float, float]


def contact_findings(code: str, points: Sequence[Point], message: str) -> tuple[Finding, ...]:
    """One error on the skin at points (N, 3) mm."""
    places = tuple(Place(mesh="skin", point_mm=point) for point in points[:MAX_PLACES])
    return (Finding(code=code, severity=Severity.ERROR, message=message, count=len(points), places=places),)


def words(point: Sequence[float]) -> str:
    """A point in mm for a message."""
    return "(" + ", ".join(f"{float(value):.4g}" for value in point) + ")"
