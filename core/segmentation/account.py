"""What is said of surfaces made of labels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.schema.finding import Finding, Severity
from core.schema.report import MeshReport
from core.segmentation.segment import Segmented

LARGEST_DIFFERENCE = 0.05  # of the volume of the voxels
LARGEST_ISLANDS = 0.05  # of the voxels of a tissue: more are hardly specks, rather its other half


def describe(made: Mapping[str, Segmented], meshes: Mapping[str, MeshReport]) -> tuple[dict[str, Any], ...]:
    """Entries of a report's changes: voxels and volumes of every surface."""
    return tuple(
        {
            "mesh": name,
            "what": "surface of labelled voxels",
            "voxels": each.labelled,
            "cavity_voxels_filled": each.filled,
            "island_voxels_dropped": each.dropped,
            "islands_dropped": each.islands,
            "voxels_taken_to_be_closed": each.sealed,
            "voxel_volume_mm3": each.voxels_mm3,
            "volume_mm3": meshes[name].volume_mm3,
        }
        for name, each in made.items()
    )


def find_findings(made: Mapping[str, Segmented], meshes: Mapping[str, MeshReport]) -> tuple[Finding, ...]:
    """Of what went, was filled, was cut off, and of volumes that differ."""
    found = []
    for name, each in made.items():
        if each.dropped:
            message = f"{name}: {each.islands} islands with {each.dropped} voxels were left out; {each.labelled} voxels stayed"
            much = each.dropped > LARGEST_ISLANDS * (each.labelled + each.dropped)
            severity = Severity.WARNING if much else Severity.INFO
            found.append(_finding("segment.islands_dropped", severity, message, each.islands))
        if each.sealed:
            message = f"{name} was open across edges of voxels: it was given {each.sealed} voxels of what it encloses"
            found.append(_finding("segment.sheet_sealed", Severity.INFO, message, each.sealed))
        if each.at_border:
            message = f"{name} has {each.at_border} voxels at the border of the volume: its surface is cut off flat there"
            found.append(_finding("segment.cut_off", Severity.WARNING, message, each.at_border))
        difference = (meshes[name].volume_mm3 or 0.0) / each.voxels_mm3 - 1.0
        if abs(difference) > LARGEST_DIFFERENCE:
            message = (
                f"the surface of {name} encloses {difference:+.1%} of its voxels' volume: parts of it are a voxel thin, or the "
                "gaps to its neighbours count"
            )
            found.append(_finding("segment.volume_differs", Severity.WARNING, message, 1))
    return tuple(found)


def _finding(code: str, severity: Severity, message: str, count: int) -> Finding:
    return Finding(code=code, severity=severity, message=message, count=count)
