"""The process `graft`: a region of one surface set into another, proven on the file that is delivered."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InternalError
from core.grafting.graft import Graft, graft
from core.io.registry import read_meshes, write_mesh
from core.mesh import Mesh
from core.processes.named_input import NamedInput, load_input
from core.processes.outcome import BEFORE, Outcome, OutputFile
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.figures.compose import draw_mesh_figures
from core.run import RunContext
from core.schema.counted import counted
from core.schema.finding import Finding, Place, Severity
from core.schema.graft import GraftInputs
from core.schema.report import Report
from core.validation.requirements import require_fit_skin
from core.validation.validate import Validation

METHODS = (
    "The region was taken out of the base and filled from the donor, as in [3], 6.4.1 to 6.4.3. Faces along the walls of the "
    "region were made finer by halving their longest edges [4]; faces within {margin:g} mm of a wall were left out of both "
    "surfaces. The rims of base and donor were joined by the band of triangles with the least sum of squared edge lengths [5], "
    "which was then refined by halving and flipping edges and follows a transition between the two surfaces. Where the "
    "band crossed a surface or folded onto it, it was widened. Coordinates were rounded to single precision, written to binary "
    "STL, read back, and proven there with exact predicates [1]: one closed, manifold, outward surface without self-intersection."
)
REFERENCES = (
    *VALIDATE_REFERENCES,
    "[3] A. T. Htet, Full-body Shell Creation for CAD Virtual Humans including Tightly-Spaced, Enclosed Shells, "
    "Worcester Polytechnic Institute",
    "[4] M.-C. Rivara, Algorithms for refining triangular grids suitable for adaptive and multigrid techniques, "
    "International Journal for Numerical Methods in Engineering 20, 1984, doi:10.1002/nme.1620200412",
    "[5] H. Fuchs, Z. M. Kedem, S. P. Uselton, Optimal surface reconstruction from planar contours, "
    "Communications of the ACM 20, 1977, doi:10.1145/359842.359846",
)
OUTPUT = "mesh"


def run_graft(inputs: GraftInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """The joined surface, and the proof of it.

    Raises: InputError `skin.*`, `region.*`, `graft.*`; LimitError `graft.seam_too_fine`; InternalError `graft.not_proven` with
    a report.
    """
    load = run.stage("load", 0.0, 0.05)
    sources = {"base": load_input(inputs.base.href, meshes), "donor": load_input(inputs.donor.href, meshes)}
    surfaces = {name: source.mesh.rounded_to_float32() for name, source in sources.items()}
    load.advance(1.0, ", ".join(f"{name} '{source.name}': {len(source.mesh.faces)} faces" for name, source in sources.items()))
    check = run.stage("check base and donor", 0.05, 0.2)
    for done, (name, mesh) in enumerate(surfaces.items()):
        check.advance(done / len(surfaces), name)
        require_fit_skin(mesh, name)
    boxes = [(region.box_mm.min, region.box_mm.max) for region in inputs.regions]
    step = run.stage("graft", 0.2, 0.6)
    made = step.checkpoint(
        "graft",
        lambda: graft(
            surfaces["base"],
            surfaces["donor"],
            boxes,
            seam_mm=inputs.seam_mm,
            max_distance_mm=inputs.max_distance_mm,
            run=step,
        ),
        *(surfaces, boxes, inputs.seam_mm, inputs.max_distance_mm),
    )
    run.stage("write and read back", 0.6, 0.62)
    delivered = _deliver(made.mesh, out_dir)
    validation = validate_once({OUTPUT: delivered}, 0.0, run.stage("prove", 0.62, 0.8))
    report = _report(inputs, sources, surfaces, made, validation)
    _require_proven(report, made.mesh, delivered)
    run.stage("figures", 0.8, 1.0)
    figures = draw_mesh_figures({OUTPUT: delivered}, findings=report.findings)
    files = (OutputFile(OUTPUT, Path(f"{OUTPUT}.stl"), "model/stl", f"{OUTPUT}.stl"),)
    return Outcome(report, figures, files, {OUTPUT: delivered, **{f"{name}{BEFORE}": mesh for name, mesh in surfaces.items()}})


def _deliver(mesh: Mesh, out_dir: Path) -> Mesh:
    """Write binary STL and read it back: what is proven is what the file holds."""
    path = out_dir / f"{OUTPUT}.stl"
    write_mesh(mesh, path, "stl", OUTPUT)
    return read_meshes(path, file_name=path.name, unit="mm").meshes[0].mesh


def _report(
    inputs: GraftInputs, sources: Mapping[str, NamedInput], surfaces: Mapping[str, Mesh], made: Graft, validation: Validation
) -> Report:
    return Report(
        process="graft",
        verdict=validation.verdict,
        summary=_summary(made),
        meshes=validation.meshes,
        nesting=validation.nesting,
        findings=(*validation.findings, _seams(made)),
        changes=_changes(sources, surfaces, made),
        methods=METHODS.format(margin=inputs.seam_mm / 2),
        references=REFERENCES,
        parameters={
            **inputs.model_dump(mode="json", exclude={"base", "donor"}),
            **{name: {"name": source.name, "sha256": source.sha256} for name, source in sources.items()},
        },
        software=software_versions(),
    )


def _summary(made: Graft) -> str:
    widest = max(seam.widest_mm for seam in made.seams)
    return (
        f"{made.donor_faces} faces of the donor set into {made.base_faces} of the base along {counted(len(made.seams), 'seam')} "
        f"of {made.band_faces} new faces; at the seams the surfaces are up to {made.apart_mm:.3g} mm apart, the widest gap "
        f"between their rims is {widest:.3g} mm."
    )


def _seams(made: Graft) -> Finding:
    places = tuple(Place(mesh=OUTPUT, point_mm=seam.point_mm) for seam in made.seams)
    message = f"base and donor were joined along {counted(len(made.seams), 'seam')}; each place is where the gap was widest"
    return Finding(code="graft.seam", severity=Severity.INFO, message=message, count=len(made.seams), places=places)


def _changes(sources: Mapping[str, NamedInput], surfaces: Mapping[str, Mesh], made: Graft) -> tuple[dict[str, Any], ...]:
    shifts = {name: float(np.abs(surfaces[name].vertices - source.mesh.vertices).max()) for name, source in sources.items()}
    return (
        *(
            {"mesh": name, "what": "coordinates rounded to float32", "largest_shift_mm": shift}
            for name, shift in shifts.items()
            if shift
        ),
        *(
            {"mesh": name, "what": "faces at the walls split without change of shape", "faces_more": more}
            for name, more in zip(sources, made.bisected, strict=True)
            if more
        ),
        {"mesh": "base", "what": "region taken out", "faces_removed": made.base_removed, "faces_kept": made.base_faces},
        {"mesh": "donor", "what": "region put in", "faces": made.donor_faces},
        *(
            {
                "mesh": OUTPUT,
                "what": f"seam {number} triangulated",
                "faces": seam.faces,
                "base_rim_vertices": seam.base_rim,
                "donor_rim_vertices": seam.donor_rim,
                "widest_gap_mm": round(seam.widest_mm, 6),
            }
            for number, seam in enumerate(made.seams, start=1)
        ),
        {"mesh": OUTPUT, "what": "distance bridged between base and donor", "largest_mm": round(made.apart_mm, 6)},
    )


def _require_proven(report: Report, made: Mesh, delivered: Mesh) -> None:
    """Never hand out a surface that breaks the promise: that would be our bug, and is said with all that is known."""
    same = np.array_equal(made.triangles(), delivered.triangles())
    if report.verdict == "simulation_ready" and report.meshes[OUTPUT].components == 1 and same:
        return
    errors = [finding for finding in report.findings if finding.severity is Severity.ERROR]
    found = report.meshes[OUTPUT]
    words = "; ".join(finding.message for finding in errors[:3]) or f"{found.components} pieces, file as made: {same}"
    raise InternalError("graft.not_proven", f"the surface made does not pass the proof: {words}", report=report, findings=())
