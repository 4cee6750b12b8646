"""Tetrahedra in tissues and what a report says of them: what `tetrahedralize` and `prepare` do alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.mesh import Mesh
from core.package.region_tag import region_tags
from core.package.tissue import Tissue
from core.package.volume_files import write_msh, write_vtu
from core.processes.outcome import OutputFile
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.figures.element_histogram import draw_element_histogram
from core.reports.figures.figure import Figure
from core.reports.palette import tissue_colours
from core.schema.finding import Finding, Severity
from core.schema.report import RegionReport
from core.schema.tetrahedralize import TetrahedraParameters
from core.tetrahedra.element_quality import quality, radius_ratio, smallest_dihedral_deg, volumes
from core.tetrahedra.fill import fill
from core.tetrahedra.tetgen_ways import WAYS
from core.tetrahedra.volume_mesh import Mesher, VolumeMesh
from core.validation.validate import Validation

METHODS = (
    "The space between the surfaces was filled with tetrahedra by {mesher} [3]{shape}, without a vertex added on a surface. It "
    "was checked that every face of every surface is a face of tetrahedra with its tissue inside and the tissue around it "
    "outside, that tetrahedra meet face to face, that none is flat or inverted, and that those of each tissue add up to the "
    "volume between its surface and those inside."
)
TETGEN_REFERENCE = (
    "[3] H. Si, TetGen, a Delaunay-based quality tetrahedral mesh generator, ACM Transactions on Mathematical Software 41, 2015, "
    "doi:10.1145/2629697"
)
GMSH_REFERENCE = (
    "[3] C. Geuzaine, J.-F. Remacle, Gmsh: a 3-D finite element mesh generator with built-in pre- and post-processing "
    "facilities, International Journal for Numerical Methods in Engineering 79, 2009, doi:10.1002/nme.2579"
)
MSH = OutputFile("msh", Path("volume.msh"), "application/x-gmsh", "volume.msh")
VTU = OutputFile("vtu", Path("volume.vtu"), "application/x-vtu", "volume.vtu")


def require_known_tissues(asked: TetrahedraParameters, names: Sequence[str]) -> None:
    """Raises: InputError `tetrahedra.unknown_tissue`."""
    unknown = sorted(set(asked.max_volume_mm3) - set(names))
    if unknown:
        raise InputError(
            "tetrahedra.unknown_tissue",
            f"max_volume_mm3 names {', '.join(unknown)}, the surfaces are {', '.join(names)}",
        )


def least_gap(min_gap_mm: float, validation: Validation) -> float:
    """What the surfaces keep from each other, or less."""
    return min([min_gap_mm, *(pair.min_gap_mm for pair in validation.pairs if pair.min_gap_mm)])


def fill_tissues(
    surfaces: Mapping[str, Mesh], validation: Validation, asked: TetrahedraParameters, min_gap_mm: float
) -> VolumeMesh:
    """Needs: surfaces that `validation` found ready. Raises: InputError `tetrahedra.no_room`, `tetrahedra.refused`;
    StateError `tetrahedra.no_mesher`; InternalError `tetrahedra.not_proven`."""
    return fill(
        surfaces,
        validation.nesting,
        gap_mm=least_gap(min_gap_mm, validation),
        mesher=asked.mesher,
        radius_edge=asked.radius_edge,
        largest_mm3=asked.max_volume_mm3,
    )


def write_volume(tissues: Sequence[Tissue], volume: VolumeMesh, out_dir: Path) -> tuple[OutputFile, ...]:
    """For gmsh and SimNIBS, and for ParaView."""
    write_msh(out_dir / MSH.path, tissues, volume)
    write_vtu(out_dir / VTU.path, tissues, volume)
    return (MSH, VTU)


def region_reports(volume: VolumeMesh, tissues: Sequence[Tissue]) -> dict[str, RegionReport]:
    """Tissue -> its tetrahedra."""
    tags = region_tags(tissues)
    return {
        tissue.name: _region_report(volume.corners()[volume.region == number], tags[tissue.name])
        for number, tissue in enumerate(tissues)
    }


def tetrahedra_summary(volume: VolumeMesh, regions: Mapping[str, RegionReport]) -> str:
    """One sentence."""
    worst = min(regions, key=lambda name: regions[name].quality_minimum)
    return (
        f"{len(volume.tetrahedra)} tetrahedra in {len(regions)} tissue{'s' if len(regions) > 1 else ''}, none inverted, volumes "
        f"proven; smallest quality {regions[worst].quality_minimum:.2g} (in {worst})."
    )


def find_other_mesher(asked: TetrahedraParameters, volume: VolumeMesh) -> tuple[Finding, ...]:
    """What a reader should know if TetGen was asked first, and gmsh filled the tissues."""
    if asked.mesher != "auto" or volume.mesher == "tetgen":
        return ()
    told = (
        f"TetGen gave up on these surfaces in all {len(WAYS)} ways to ask it, so gmsh filled them; the proof is the same, "
        "`radius_edge` is not kept"
    )
    return (Finding(code="tetrahedra.by_gmsh", severity=Severity.INFO, message=told, count=1),)


def tetrahedra_methods(asked: TetrahedraParameters, mesher: Mesher) -> str:
    """Citable; numbers are those of `tetrahedra_references`. mesher: who made them."""
    if mesher == "gmsh":
        return METHODS.format(mesher="gmsh", shape=" by Delaunay refinement, as fine as the surfaces around")
    ratio = f" with a ratio of circumradius to shortest edge of at most {asked.radius_edge or 0:g} where the surfaces allow it"
    return METHODS.format(mesher="TetGen", shape="" if asked.radius_edge is None else ratio)


def tetrahedra_references(mesher: Mesher) -> tuple[str, ...]:
    """Of the checks, and of the mesher."""
    return (*VALIDATE_REFERENCES, GMSH_REFERENCE if mesher == "gmsh" else TETGEN_REFERENCE)


def mesher_version(mesher: Mesher) -> dict[str, str]:
    """Its name and version, for the list of software."""
    return {mesher: version(mesher)}


def draw_elements(volume: VolumeMesh, tissues: Sequence[Tissue]) -> Figure:
    """Quality of tetrahedra, tissue by tissue."""
    shapes = quality(volume.corners())
    named = {tissue.name: shapes[volume.region == number] for number, tissue in enumerate(tissues)}
    return draw_element_histogram(named, tissue_colours(list(named)))


def _region_report(corners: NDArray[np.float64], tag: int) -> RegionReport:
    shapes, angles, ratios = quality(corners), smallest_dihedral_deg(corners), radius_ratio(corners)
    return RegionReport(
        region_tag=tag,
        tetrahedra=len(corners),
        volume_mm3=float(volumes(corners).sum()),
        quality_minimum=float(shapes.min()),
        quality_percentile_1=float(np.percentile(shapes, 1)),
        quality_median=float(np.median(shapes)),
        smallest_dihedral_deg=float(angles.min()),
        dihedral_percentile_1_deg=float(np.percentile(angles, 1)),
        radius_ratio_minimum=float(ratios.min()),
        radius_ratio_median=float(np.median(ratios)),
    )
