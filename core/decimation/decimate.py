"""Fewer faces, the same surface."""

from __future__ import annotations

from collections.abc import Mapping

from core.decimation.decimated import Decimated
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.decimate import DecimateInputs


def decimate(surfaces: Mapping[str, Mesh], inputs: DecimateInputs, run: RunContext = SILENT) -> dict[str, Decimated]:
    """Decimate surfaces by name; several of them stay `inputs.min_gap_mm` apart."""
    raise NotImplementedError
