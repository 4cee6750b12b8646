"""The validation of surfaces as a step that another attempt of the job need not repeat."""

from __future__ import annotations

from collections.abc import Mapping

from core.mesh import Mesh
from core.run import RunContext
from core.validation.validate import Validation, validate


def validate_once(surfaces: Mapping[str, Mesh], min_gap_mm: float, run: RunContext) -> Validation:
    """As `validate`. What was kept holds for exactly these surfaces, bit for bit."""
    return run.checkpoint("validate", lambda: validate(surfaces, min_gap_mm=min_gap_mm, run=run), surfaces, min_gap_mm)
