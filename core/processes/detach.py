"""The process `detach`: parts of a skin that touch set apart, proven on the file that is delivered."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from core.detaching.detach import Detached, OpenedContact, detach
from core.errors import InternalError
from core.geometry.body_frame import find_body_frame
from core.mesh import Mesh
from core.processes.loaded_skin import LoadedSkin, load_skin
from core.processes.outcome import Outcome, OutputFile, with_originals
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.processes.written_surfaces import write_and_read_back
from core.reports.figures.compose import draw_mesh_figures
from core.reports.figures.contact_sections import ShownContact, draw_contact_sections
from core.run import RunContext
from core.schema.counted import counted
from core.schema.detach import DetachInputs, DetachSettings
from core.schema.finding import Finding, Place, Severity
from core.schema.report import Report
from core.validation.requirements import require_closed_skin
from core.validation.validate import Validation

METHODS = (
    "Parts that touch were set apart as in [3], 5.3, without a hand. Where the skin ran through itself it was united first. In "
    "each region the body was filled with cubes; parts were told apart by the merge tree of the distance to the skin, a contact "
    "being where it falls to at most {narrowing:g} of the "
    "depth of the thinner part. The surface of least area between the parts is a minimal cut of the cubes' graph [4]. It was "
    "drawn as a sheet of triangles, halfway between the parts outside of the body and bending least inside [5]. A slab of air "
    "along the sheet was subtracted exactly, the seams were remeshed, and the new surfaces bent [5] so that they go on into the "
    "skin around them, at least {gap:g} mm apart. Coordinates were rounded to single precision, written to binary STL, read "
    "back, and proven there with exact predicates [1]: closed, manifold, outward, free of self-intersection. No "
    "other face with a corner outside of the regions changed, bit for bit."
)
REFERENCES = (
    *VALIDATE_REFERENCES,
    "[3] A. T. Htet, Full-body Shell Creation for CAD Virtual Humans including Tightly-Spaced, Enclosed Shells, "
    "Worcester Polytechnic Institute",
    "[4] Y. Boykov, V. Kolmogorov, Computing geodesics and minimal surfaces via graph cuts, ICCV 2003, "
    "doi:10.1109/ICCV.2003.1238310",
    "[5] M. Botsch, L. Kobbelt, An intuitive framework for real-time freeform modeling, ACM Transactions on Graphics 23, 2004, "
    "doi:10.1145/1015706.1015772",
)
OUTPUT = "skin"


def run_detach(inputs: DetachInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """The skin with all contacts open, and the proof of it.

    Raises: InputError `skin.*`, `region.outside_mesh`, `detach.*`, `heal.*`; InternalError `detach.not_proven` with a report.
    """
    source = load_skin(inputs.skin.href, meshes, run, require_closed_skin)
    settings = DetachSettings.model_validate(inputs.model_dump(exclude={"skin"}))
    step = run.stage("detach", 0.06, 0.6)
    made = step.checkpoint("detach", lambda: detach(source.mesh, settings, step), source.mesh, settings)
    run.stage("write and read back", 0.6, 0.62)
    delivered = write_and_read_back({OUTPUT: made.mesh}, out_dir)
    validation = validate_once(delivered, 0.0, run.stage("prove", 0.62, 0.8))
    report = _report(inputs, source, made, validation)
    _require_proven(report, made, delivered[OUTPUT])
    run.stage("figures", 0.8, 1.0)
    shown = [ShownContact(each.region, each.middle_mm, each.normal, each.area_mm2) for each in made.contacts]
    figures = (
        draw_contact_sections(source.mesh, delivered[OUTPUT], find_body_frame(source.mesh), shown),
        *draw_mesh_figures(delivered, findings=report.findings),
    )
    files = (OutputFile(OUTPUT, Path(f"{OUTPUT}.stl"), "model/stl", f"{OUTPUT}.stl"),)
    return Outcome(report, figures, files, with_originals(delivered, {OUTPUT: source.mesh}))


def _report(inputs: DetachInputs, source: LoadedSkin, made: Detached, validation: Validation) -> Report:
    return Report(
        process="detach",
        verdict=validation.verdict,
        summary=_summary(made),
        meshes=validation.meshes,
        nesting=validation.nesting,
        findings=(*validation.findings, *contact_findings_of(made)),
        changes=(*source.changes, *(_change(contact) for contact in made.contacts)),
        methods=METHODS.format(narrowing=inputs.narrowing, gap=inputs.gap_mm),
        references=REFERENCES,
        parameters={
            **inputs.model_dump(mode="json", exclude={"skin"}),
            "skin": {"name": source.name, "sha256": source.sha256},
        },
        software=software_versions(),
    )


def _summary(made: Detached) -> str:
    area = sum(contact.area_mm2 for contact in made.contacts)
    lost = sum(contact.volume_mm3 for contact in made.contacts)
    smallest = min(contact.gap_mm for contact in made.contacts)
    handles = [made.contacts[0].genus_before, made.contacts[-1].genus_after]
    count = len(made.contacts)
    contacts, pieces = "contacts" if count > 1 else "contact", "pieces" if made.pieces > 1 else "piece"
    return (
        f"{count} {contacts} of {area / 100:.3g} cm² opened, at least {smallest:.3g} mm wide; the body lost "
        f"{lost / 1000:.3g} cm³; genus {handles[0]} before, {handles[1]} after; {made.pieces} {pieces}."
    )


def contact_findings_of(made: Detached) -> tuple[Finding, ...]:
    """Where contacts were opened, and where a slit ends within the body."""
    opened = tuple(Place(mesh=OUTPUT, point_mm=contact.middle_mm) for contact in made.contacts)
    message = f"{counted(len(opened), 'contact')} were opened; each place is the middle of one"
    findings = [Finding(code="detach.opened", severity=Severity.INFO, message=message, count=len(opened), places=opened)]
    if count := len(made.crossing):
        united = f"{counted(count, 'pair')} of faces ran through each other; the parts were united first, wherever that was"
        findings.insert(0, Finding(code="detach.united", severity=Severity.INFO, message=united, count=count))
    ending = [contact for contact in made.contacts if contact.end_mm > 0.0]
    if ending:
        places = tuple(Place(mesh=OUTPUT, point_mm=contact.middle_mm) for contact in ending)
        words = ", ".join(f"'{contact.region}' over {contact.end_mm:.3g} mm" for contact in ending[:8])
        message = f"the contact goes on beyond the box, so the slit ends inside of the body: {words}"
        findings.append(
            Finding(code="detach.ends_in_body", severity=Severity.WARNING, message=message, count=len(ending), places=places)
        )
    return tuple(findings)


def _change(contact: OpenedContact) -> dict[str, Any]:
    numbers = {key: round(value, 4) if isinstance(value, float) else value for key, value in asdict(contact).items()}
    return {"mesh": OUTPUT, "what": f"contact opened in region '{numbers.pop('region')}'", **numbers}


def _require_proven(report: Report, made: Detached, delivered: Mesh) -> None:
    """Never hand out a surface that breaks the promise: that would be our bug, and is said with all that is known."""
    same = np.array_equal(made.mesh.triangles(), delivered.triangles())
    errors = [finding for finding in report.findings if finding.severity is Severity.ERROR]
    found = report.meshes[OUTPUT]
    if not errors and found.components == made.pieces and same:
        return
    words = "; ".join(finding.message for finding in errors[:3]) or f"{found.components} pieces, file as made: {same}"
    raise InternalError("detach.not_proven", f"the surface made does not pass the proof: {words}", report=report, findings=())
