"""The step `detach`: parts of the skin that are grown together where they touch, such as arm and torso, set apart."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from core.detaching.detach import Detached, OpenedContact, detach
from core.geometry.body_frame import find_body_frame
from core.mesh import Mesh
from core.processes.detach import METHODS, REFERENCES, contact_findings_of
from core.processes.preparation.skin_steps import SKIN
from core.processes.preparation.step_log import STEPS, StepLog
from core.reports.figures.contact_sections import ShownContact, draw_contact_sections
from core.reports.figures.figure import Figure
from core.schema.prepare import PrepareInputs
from core.schema.report import StepReport


def detach_parts(inputs: PrepareInputs, skin: Mesh, log: StepLog) -> Mesh:
    """With all contacts open. Raises: InputError `region.outside_mesh`, `detach.*`; InternalError `detach.not_proven`."""
    asked = inputs.detach
    if asked is None:
        log.leave_out("detach", "not asked for")
        return skin
    made = log.take("detach", lambda run: detach(skin, asked, run), skin, asked)
    area_mm2 = sum(contact.area_mm2 for contact in made.contacts)
    lost_mm3 = sum(contact.volume_mm3 for contact in made.contacts)
    least_mm = min(contact.gap_mm for contact in made.contacts)
    log.tell(
        StepReport(
            name="detach",
            title=STEPS["detach"][0],
            summary=f"Contacts opened: {len(made.contacts)}, {area_mm2 / 100:.3g} cm² in all, at least {least_mm:.3g} mm wide; "
            f"the body lost {lost_mm3 / 1000:.3g} cm³.",
            numbers={
                "contacts": len(made.contacts),
                "area of contacts [cm²]": round(area_mm2 / 100, 3),
                "smallest gap [mm]": round(least_mm, 4),
                "volume taken [mm³]": round(lost_mm3, 1),
                "faces before": len(skin.faces),
                "faces after": len(made.mesh.faces),
                "genus before": made.contacts[0].genus_before,
                "genus after": made.contacts[-1].genus_after,
            },
            findings=contact_findings_of(made),
            changes=tuple(_change(contact) for contact in made.contacts),
            methods=METHODS.format(narrowing=asked.narrowing, gap=asked.gap_mm),
            references=REFERENCES,
            parameters=asked.model_dump(mode="json"),
        ),
        {SKIN: made.mesh},
        lambda _surfaces: _draw(skin, made),
    )
    return made.mesh


def _change(contact: OpenedContact) -> dict[str, Any]:
    numbers = {key: round(value, 4) if isinstance(value, float) else value for key, value in asdict(contact).items()}
    return {"mesh": SKIN, "what": f"contact opened in region '{numbers.pop('region')}'", **numbers}


def _draw(skin: Mesh, made: Detached) -> tuple[Figure, ...]:
    shown = [ShownContact(each.region, each.middle_mm, each.normal, each.area_mm2) for each in made.contacts]
    return (draw_contact_sections(skin, made.mesh, find_body_frame(skin), shown),)
