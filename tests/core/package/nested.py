"""Three nested spheres with a real report and real figures, packed in a fraction of a second."""

from __future__ import annotations

from functools import cache

import numpy as np

from core.package.conductivity import conductivity_of
from core.package.tissue import FREE_SPACE, Tissue
from core.reports.figures import Figure, draw_shell_figures
from core.schema.report import Report
from core.validation.validate import validate
from tests.solids import sphere

RADII_MM = {"skin": 30.0, "fat": 29.0, "average_body": 27.0}


@cache
def tissues() -> tuple[Tissue, ...]:
    """In nesting order; radii from thirds of a millimetre, so that float32 and float64 differ."""
    names = list(RADII_MM)
    return tuple(
        Tissue(
            name,
            sphere(radius / 3.0, 3, at=(0.1, 0.2, 0.3)).rounded_to_float32(),
            None if name == "skin" else (RADII_MM["skin"] - radius) / 3.0,
            conductivity_of(name),
            enclosing,
        )
        for (name, radius), enclosing in zip(RADII_MM.items(), [FREE_SPACE, *names], strict=False)
    )


@cache
def report() -> Report:
    """Validated for real."""
    validation = validate({tissue.name: tissue.mesh for tissue in tissues()})
    return Report(
        process="shells",
        verdict=validation.verdict,
        summary="3 nested spheres.",
        meshes=validation.meshes,
        pairs=validation.pairs,
        nesting=validation.nesting,
        findings=validation.findings,
        parameters={"min_gap_mm": 0.05, "skin": {"name": "ball", "sha256": "cd" * 32}},
        software={"integument-server": "0.1.0", "numpy": np.__version__},
    )


@cache
def figures() -> tuple[Figure, ...]:
    """Without thickness: two pictures are enough to pack."""
    return draw_shell_figures(tissues(), {}, pairs=report().pairs)
