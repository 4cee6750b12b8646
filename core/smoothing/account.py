"""What a report says about a smoothed surface."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from core.schema.counted import counted
from core.schema.finding import Finding, Severity
from core.schema.smooth import SmoothInputs
from core.smoothing.journey import Journey
from core.smoothing.progress import Progress
from core.validation.measure import significant
from core.validation.places import vertex_places

Floats = NDArray[np.float64]

NOTABLE_VOLUME_CHANGE = 0.01  # relative; more is worth a warning


def describe(
    journey: Journey, mesh: Mesh, original: Mesh, deviation: Floats, original_deviation: Floats, inputs: SmoothInputs
) -> dict[str, Any]:
    """Plain JSON facts: before, after, how far, and every iteration for a plot."""
    before, after = journey.progress[0], journey.progress[journey.delivered]
    moved = (mesh.vertices != original.vertices).any(axis=1)
    change = volume_change(journey)
    message = (
        f"{inputs.method}: {int(moved.sum())} of {len(moved)} vertices moved in {counted(journey.delivered, 'iteration')}, "
        f"lowest quality {before.lowest_quality:.4g} -> {after.lowest_quality:.4g}, "
        f"mean {before.mean_quality:.4g} -> {after.mean_quality:.4g}"
    )
    if change is not None:
        message += f", volume {100 * change:+.3f} %"
    return {
        "kind": "smoothing",
        "message": message,
        "method": inputs.method,
        "iterations_made": len(journey.progress) - 1,
        "iteration_delivered": journey.delivered,
        "iteration_best": journey.best,
        "vertices_movable": len(journey.state.chosen),
        "vertices_moved": int(moved.sum()),
        "edges_flipped": sum(state.flipped for state in journey.progress[: journey.delivered + 1]),
        "volume_change": None if change is None else significant(change),
        "area_change": significant(after.area_mm2 / before.area_mm2 - 1.0),
        "largest_shift_mm": significant(after.largest_shift_mm),
        "max_deviation_mm": significant(float(max(deviation.max(), original_deviation.max()))),
        "rms_deviation_mm": significant(float(np.sqrt((deviation**2).mean()))),
        "iterations": [_numbers(state) for state in journey.progress],
    }


def volume_change(journey: Journey) -> float | None:
    """Relative; None for an open surface."""
    before, after = journey.progress[0].volume_mm3, journey.progress[journey.delivered].volume_mm3
    return None if before is None or after is None else after / before - 1.0


def find_findings(name: str, mesh: Mesh, journey: Journey) -> tuple[Finding, ...]:
    """What a reader should know."""
    found = []
    last = journey.progress[-1]
    if len(journey.state.chosen) and journey.delivered == 0:
        found.append(
            Finding(
                code="smooth.no_gain",
                severity=Severity.INFO,
                message=f"{name} is as it was: in {counted(last.iteration, 'iteration')} its lowest quality "
                f"{journey.progress[0].lowest_quality:.4g} did not rise",
                count=1,
                places=vertex_places(name, mesh, journey.state.chosen[:1]),
            )
        )
    restrained = np.flatnonzero(journey.state.restrained)
    if len(restrained):
        found.append(
            Finding(
                code="smooth.steps_shortened",
                severity=Severity.INFO,
                message=f"{len(restrained)} of {len(journey.state.chosen)} vertices of {name} were kept from going all their "
                "way in some iteration, so that no face crosses, folds, turns over or loses its shape",
                count=len(restrained),
                places=vertex_places(name, mesh, restrained[np.argsort(-journey.state.restrained[restrained], kind="stable")]),
            )
        )
    change = volume_change(journey)
    if change is not None and abs(change) > NOTABLE_VOLUME_CHANGE:
        found.append(
            Finding(
                code="smooth.volume_changed",
                severity=Severity.WARNING,
                message=f"the volume of {name} changed by {change:+.2%}",
                count=1,
            )
        )
    return tuple(found)


def _numbers(state: Progress) -> dict[str, Any]:
    return {key: significant(value) if isinstance(value, float) else value for key, value in asdict(state).items()}
