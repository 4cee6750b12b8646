"""The report: what was done and what was proven (`report.json`). No wall times, ids or dates: equal jobs give equal bytes."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from core.errors import Fault
from core.schema.finding import Finding
from core.schema.model import FrozenModel

Verdict = Literal["simulation_ready", "not_ready"]
# the thesis' three cases (Fig. 19), a = master mesh, b = slave mesh
Relation = Literal["a_inside_b", "b_inside_a", "disjoint", "intersecting", "undetermined"]
StepOutcome = Literal["done", "not_needed", "failed", "not_reached"]


class QualityNumbers(FrozenModel):
    """Triangle quality q = 2 r_in / r_out (thesis 2.4.1), 1 for an equilateral triangle."""

    minimum: float
    percentile_1: float
    median: float
    mean: float


class EdgeNumbers(FrozenModel):
    """Edge lengths in mm."""

    minimum_mm: float
    median_mm: float
    maximum_mm: float


class MeshReport(FrozenModel):
    """All that is known of one mesh."""

    vertices: int
    faces: int
    components: int
    euler_characteristic: int
    genus: int | None = Field(description="Sum over the components; null unless closed and manifold")
    closed: bool = Field(description="Every edge has exactly two faces")
    edge_manifold: bool = Field(description="No edge has more than two faces")
    vertex_manifold: bool = Field(description="The faces around every vertex form one fan")
    consistently_oriented: bool
    oriented_outward: bool | None = Field(description="null unless closed, manifold and consistently oriented")
    degenerate_faces: int
    duplicate_faces: int
    self_intersecting_pairs: int = Field(description="Exact: pairs of faces that meet other than in shared corners and edges")
    area_mm2: float
    volume_mm3: float | None = Field(description="null unless closed")
    extents_mm: tuple[float, float, float]
    quality: QualityNumbers
    edges: EdgeNumbers
    minimum_dihedral_deg: float | None = Field(description="Smallest angle between two neighbouring faces, 180 is flat")
    sha256: str | None = Field(None, description="Of the delivered STL; null for a mesh that came and was not handed out again")


class PairReport(FrozenModel):
    """Two meshes of the set against each other."""

    a: str
    b: str
    relation: Relation
    intersecting_pairs: int = Field(description="Exact number of intersecting face pairs")
    case_1: int = Field(description="Thesis Fig. 19: faces of b cross the plane region of a face of a by their edges")
    case_2: int = Field(description="Thesis Fig. 19: the edges of both faces cross the other")
    case_3: int = Field(description="Thesis Fig. 19: edges of the face of a cross the face of b")
    min_gap_mm: float | None = Field(description="Smallest distance between the two surfaces; 0 if they meet")
    min_gap_point_mm: tuple[float, float, float] | None = None


class ThicknessReport(FrozenModel):
    """How well one layer keeps its depth. Shares are of the layer's area; depth is the Euclidean distance to the skin."""

    side: Literal["inside", "outside"] = Field("inside", description="On which side of the skin the layer lies")
    target_mm: float = Field(
        description="Depth asked for outside all regions; if it was given for each vertex, the median by area of all asked for"
    )
    target_array: str | None = Field(None, description="Array of the skin's upload that gave the depths, if one did")
    on_target_area: float = Field(ge=0, le=1, description="Within 5 % of the local target")
    limited_area: float = Field(ge=0, le=1, description="Off target where the reach does not allow the target")
    missed_area: float = Field(ge=0, le=1, description="Off target although the reach would allow it")
    min_mm: float
    max_mm: float
    percentiles_mm: dict[str, float] = Field(description='Keys "1", "5", "25", "50", "75", "95", "99"')


class DeviationNumbers(FrozenModel):
    """Distances between a surface and the one it was made from, measured at vertices and in the middles of faces."""

    maximum_mm: float = Field(description="The larger of both ways")
    rms_mm: float = Field(description="Root mean square over the area of both")
    from_original_mm: float = Field(description="Largest distance from the original to the result")
    to_original_mm: float = Field(description="Largest distance from the result to the original")
    at_mm: tuple[float, float, float] = Field(description="Where they are farthest apart")


class ComparisonReport(FrozenModel):
    """A surface against the one it was made from."""

    before: MeshReport = Field(description="The surface as it came, rounded to float32")
    kept_vertices: int = Field(description="Vertices of the result that the original has bit for bit")
    deviation: DeviationNumbers
    area_change: float | None = Field(description="Share of the area before; null if there was none")
    volume_change: float | None = Field(description="Share of the volume before; null unless both are closed")


class RegionReport(FrozenModel):
    """The tetrahedra of one tissue. Quality is volume over the cube of the root mean square edge, 1 for the regular one."""

    region_tag: int = Field(description="The tissue's number in the files")
    tetrahedra: int
    volume_mm3: float = Field(description="Of all of them; proven to be that between the surface and those inside it")
    quality_minimum: float
    quality_percentile_1: float
    quality_median: float
    smallest_dihedral_deg: float = Field(description="Smallest angle between two faces of a tetrahedron; 70.5 in the regular one")
    dihedral_percentile_1_deg: float = Field(description="Smallest such angle of a tetrahedron: 1 of 100 have less")
    radius_ratio_minimum: float = Field(
        description="Three radii of the inscribed sphere over that of the circumscribed one, 1 in the regular tetrahedron"
    )
    radius_ratio_median: float


class FieldNumbers(FrozenModel):
    """Of one quantity on a surface, V/m; mean and percentile by area."""

    mean: float
    percentile_99: float
    maximum: float


class FieldReport(FrozenModel):
    """A field on one surface. Triangles too far from the field have no value and count in none of the numbers."""

    faces: int
    too_far: int = Field(description="Triangles without a value")
    area_with_value_mm2: float
    farthest_mm: float = Field(description="Largest distance from a triangle to the place its value was, or would be, taken from")
    method: str = Field(description="Where the values were taken")
    magnitude: FieldNumbers | None = Field(None, description="null if no triangle has a value")
    maximum_at_mm: tuple[float, float, float] | None = Field(
        None, description="Centre of the triangle with the largest magnitude"
    )
    maximum_face: int | None = Field(None, description="Its number, from 1 as in MATLAB")
    normal: FieldNumbers | None = Field(None, description="Size of the part along the normal; null of magnitudes alone")
    tangential: FieldNumbers | None = Field(None, description="Of the part in the triangle")


class CoilReport(FrozenModel):
    """A coil beside the surfaces, as placed."""

    dipoles: int
    wire_pieces: int
    surface: str = Field(description="The largest surface, to which the distance is")
    distance_mm: float = Field(description="Smallest distance of a dipole or piece of wire to it")
    nearest_at_mm: tuple[float, float, float] = Field(description="Where that dipole or piece is")
    inside: int = Field(description="Dipoles and pieces inside of it; 0 if it is not closed")


class StepReport(FrozenModel):
    """One step of a job made of several (`prepare`): a section of its own on the page, a line in the list of steps.

    How a process fills it: one `StepReport` per step, in order, in `Report.steps`; give what the step knows and leave the rest.
    `core.reports.steps.figures_of_step` marks its figures, `core.reports.steps.joined_methods` makes `Report.methods` and
    `Report.references` of those of all steps. `Report.meshes`, `pairs` and `findings` stay those of the final result.
    A step that fails raises with `report=Report(..., steps=...)`, the step itself with outcome "failed" and those after it
    "not_reached", and sets `error.figures`: the report of the failed job shows all of it.
    """

    name: str = Field(pattern=r"^[a-z][a-z0-9_]{0,39}$", description="Unique in the report; names of its figures begin with it")
    title: str = Field(description="For people, such as `Ears grafted`")
    outcome: StepOutcome = "done"
    summary: str = Field(description="One sentence with numbers: what was done, or why not")
    numbers: dict[str, int | float | str] = Field({}, description="Quantity with its unit -> value, in the order to be read")
    meshes: dict[str, MeshReport] = Field({}, description="The surfaces as the step leaves them, if it checked them")
    pairs: tuple[PairReport, ...] = ()
    thickness: dict[str, ThicknessReport] = {}
    comparisons: dict[str, ComparisonReport] = {}
    regions: dict[str, RegionReport] = {}
    findings: tuple[Finding, ...] = Field((), description="Of this step alone; those that decide the verdict are the report's")
    changes: tuple[dict[str, Any], ...] = ()
    methods: str = Field("", description="Citable text; `[1]` is the first of the references below")
    references: tuple[str, ...] = ()
    parameters: dict[str, Any] = {}
    checksums: dict[str, str] = Field({}, description="Name of a surface the step took or left -> SHA-256 of its file")


class FailureReport(FrozenModel):
    """Why a job ended without its results."""

    code: str = Field(description="As in the problem and on the page of errors")
    fault: Fault = Field(description="Whose: that of the request or its files, a limit, or the server's")


class Report(FrozenModel):
    """The whole report of a job."""

    process: str
    verdict: Verdict
    failure: FailureReport | None = Field(None, description="null of a job that did what it promises, whatever its verdict")
    summary: str = Field(description="One sentence for people")
    meshes: dict[str, MeshReport] = {}
    pairs: tuple[PairReport, ...] = ()
    thickness: dict[str, ThicknessReport] = {}
    comparisons: dict[str, ComparisonReport] = Field({}, description="Mesh name -> what became of the surface that came")
    regions: dict[str, RegionReport] = Field({}, description="Tissue -> its tetrahedra")
    fields: dict[str, FieldReport] = Field({}, description="Surface -> the field on it")
    coil: CoilReport | None = None
    nesting: dict[str, str | None] = Field({}, description="Mesh name -> the mesh that encloses it most closely, or null")
    findings: tuple[Finding, ...] = ()
    changes: tuple[dict[str, Any], ...] = ()
    steps: tuple[StepReport, ...] = Field((), description="Of a job made of several steps, in order; empty for all others")
    methods: str = Field("", description="Citable text of what was done")
    references: tuple[str, ...] = ()
    parameters: dict[str, Any] = {}
    software: dict[str, str] = {}
