"""The step `tetrahedra`: the space of every tissue filled, a region each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from core.mesh import Mesh
from core.package.tissue import Tissue
from core.processes.preparation.step_log import STEPS, StepLog
from core.processes.tissue_filling import (
    draw_elements,
    fill_tissues,
    find_other_mesher,
    region_reports,
    tetrahedra_methods,
    tetrahedra_references,
    tetrahedra_summary,
)
from core.schema.prepare import PrepareInputs
from core.schema.report import RegionReport, StepReport
from core.tetrahedra.volume_mesh import VolumeMesh
from core.validation.validate import Validation


def fill_all(
    inputs: PrepareInputs, tissues: Sequence[Tissue], validation: Validation, log: StepLog
) -> tuple[VolumeMesh | None, dict[str, RegionReport]]:
    """None if nobody asked. Regions are numbered as the tissues are ordered.

    Raises: InputError `tetrahedra.no_room`, `tetrahedra.refused`; StateError `tetrahedra.no_mesher`;
    InternalError `tetrahedra.not_proven`.
    """
    asked = inputs.tetrahedra
    if asked is None:
        log.leave_out("tetrahedra", "not asked for")
        return None, {}
    surfaces: dict[str, Mesh] = {tissue.name: tissue.mesh for tissue in tissues}
    nesting: Mapping[str, str | None] = dict(validation.nesting)
    volume = log.take(
        "tetrahedra",
        lambda _run: fill_tissues(surfaces, validation, asked, inputs.min_gap_mm),
        *(surfaces, nesting, [pair.min_gap_mm for pair in validation.pairs], asked.model_dump(mode="json"), inputs.min_gap_mm),
    )
    regions = region_reports(volume, tissues)
    log.tell(
        StepReport(
            name="tetrahedra",
            title=STEPS["tetrahedra"][0],
            summary=tetrahedra_summary(volume, regions),
            numbers={
                "tetrahedra": len(volume.tetrahedra),
                "regions": len(regions),
                "vertices added": len(volume.vertices) - sum(len(mesh.vertices) for mesh in surfaces.values()),
            },
            findings=find_other_mesher(asked, volume),
            methods=tetrahedra_methods(asked, volume.mesher),
            references=tetrahedra_references(volume.mesher),
        ),
        draw=lambda _surfaces: (draw_elements(volume, tissues),),
    )
    return volume, regions
