"""What a process hands back: a report, pictures for it, and files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from core.reports.figures.figure import Figure
from core.reports.scene.scene import Painted
from core.schema.report import Report

BEFORE = " before"  # as on the web page


@dataclass(frozen=True, slots=True)
class OutputFile:
    """One file a client can fetch; `path` is relative to the folder the process was given."""

    name: str
    path: Path
    media_type: str
    file_name: str

    def listed(self, out_dir: Path) -> dict[str, str]:
        """As the worker is told of it; `out_dir` is the folder the process was given."""
        return {
            "name": self.name,
            "path": str(out_dir / self.path),
            "media_type": self.media_type,
            "file_name": self.file_name,
        }


@dataclass(frozen=True, eq=False, slots=True)
class Outcome:
    """The end of a process; `report.verdict` may be not_ready though it did what it promises.

    surfaces: what the report shows in 3D; one whose name ends with `BEFORE` is hidden until asked for.
    depths_mm: distance of vertices (V,) or faces (F,) of some of them to the skin, to be painted on them; or what `painted`
    calls it.
    """

    report: Report
    figures: tuple[Figure, ...]
    files: tuple[OutputFile, ...] = ()
    surfaces: Mapping[str, Mesh] = field(default_factory=dict)
    depths_mm: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    painted: Painted | None = None


def with_originals(results: Mapping[str, Mesh], originals: Mapping[str, Mesh]) -> dict[str, Mesh]:
    """Results with what they were made from, for `Outcome.surfaces`; an original that is unchanged is left out."""
    former = {name: mesh for name, mesh in originals.items() if name in results and mesh is not results[name]}
    return {**results, **{f"{name}{BEFORE}": mesh for name, mesh in former.items()}}
