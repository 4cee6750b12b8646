"""Findings: what a check saw, in words a user can act on and places a viewer can show."""

from __future__ import annotations

from enum import StrEnum

from pydantic import Field

from core.schema.model import FrozenModel

MAX_PLACES = 100  # a finding names its worst places; `count` says how many there are


class Severity(StrEnum):
    """error: the mesh or set is not simulation ready. warning: look at it. info: good to know."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


class Place(FrozenModel):
    """Where on which mesh."""

    mesh: str = Field(description="Name of the mesh, as in the request or the package")
    point_mm: tuple[float, float, float] = Field(description="A point to fly to")
    faces: tuple[int, ...] = Field((), description="Face numbers, 0-based")
    vertices: tuple[int, ...] = Field((), description="Vertex numbers, 0-based")


class Finding(FrozenModel):
    """One result of one check."""

    code: str = Field(description="Stable, dotted: `mesh.edge_not_manifold`", pattern=r"^[a-z_]+(\.[a-z0-9_]+)+$")
    severity: Severity
    message: str = Field(description="One sentence with numbers and units")
    count: int = Field(ge=0)
    places: tuple[Place, ...] = Field((), description=f"The first or worst {MAX_PLACES} places")


def has_errors(findings: tuple[Finding, ...] | list[Finding]) -> bool:
    """True if any finding forbids the verdict `simulation_ready`."""
    return any(finding.severity is Severity.ERROR for finding in findings)
