"""Reports: what was done and what was proven. Unknown keys are kept (`report.as_json()` has all of them)."""

from __future__ import annotations

from typing import Any, Literal

from integument.answer import Answer

Point = tuple[float, float, float]


class Finding(Answer):
    """What one check saw."""

    code: str
    severity: Literal["error", "warning", "info"]
    message: str
    count: int = 0
    places: tuple[dict[str, Any], ...] = ()


class QualityNumbers(Answer):
    """Triangle quality, 1 for an equilateral triangle."""

    minimum: float
    median: float | None = None


class MeshNumbers(Answer):
    """One mesh of the set."""

    vertices: int
    faces: int
    closed: bool | None = None
    self_intersecting_pairs: int
    quality: QualityNumbers | None = None
    area_mm2: float | None = None
    volume_mm3: float | None = None


class PairNumbers(Answer):
    """Two meshes of the set against each other."""

    a: str
    b: str
    relation: str
    intersecting_pairs: int
    min_gap_mm: float | None = None


class ThicknessNumbers(Answer):
    """How well one layer keeps its depth; shares of its area."""

    target_mm: float
    on_target_area: float
    limited_area: float
    missed_area: float = 0.0
    min_mm: float | None = None


class DeviationNumbers(Answer):
    """Distances to the surface it was made from, in mm."""

    maximum_mm: float
    rms_mm: float | None = None


class ComparisonNumbers(Answer):
    """A surface against the one it was made from; changes are shares."""

    before: MeshNumbers
    deviation: DeviationNumbers
    kept_vertices: int | None = None
    area_change: float | None = None
    volume_change: float | None = None


class StepNumbers(Answer):
    """One step of a job made of several; `numbers` are quantities with their units."""

    name: str
    title: str = ""
    outcome: str
    summary: str = ""
    numbers: dict[str, int | float | str] = {}
    findings: tuple[Finding, ...] = ()


class Report(Answer):
    """The report of one job."""

    process: str = ""
    verdict: str
    summary: str = ""
    meshes: dict[str, MeshNumbers] = {}
    pairs: tuple[PairNumbers, ...] = ()
    thickness: dict[str, ThicknessNumbers] = {}
    comparisons: dict[str, ComparisonNumbers] = {}
    steps: tuple[StepNumbers, ...] = ()
    nesting: dict[str, str | None] = {}
    findings: tuple[Finding, ...] = ()
    timings_s: dict[str, float] = {}

    def smallest_gap_mm(self, mesh: str) -> float | None:
        """From this mesh to the nearest other one; null when alone or not measured."""
        gaps = [pair.min_gap_mm for pair in self.pairs if mesh in (pair.a, pair.b) and pair.min_gap_mm is not None]
        return min(gaps, default=None)

    def intersections(self, mesh: str) -> int:
        """Intersecting face pairs, of the mesh with itself and with any other."""
        others = sum(pair.intersecting_pairs for pair in self.pairs if mesh in (pair.a, pair.b))
        return self.meshes[mesh].self_intersecting_pairs + others
