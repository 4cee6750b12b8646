"""Labels of voxels to surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from core.decimation.decimate import decimate
from core.errors import InputError, InternalError
from core.geometry.exact_intersection import find_intersecting_faces
from core.label_volume import LabelVolume
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.decimate import DecimateInputs
from core.schema.reference import MeshReference
from core.schema.segment import SegmentParameters
from core.schema.smooth import SmoothInputs
from core.segmentation.border import Border, balance, find_borders
from core.segmentation.give_way import give_way
from core.segmentation.labelled_region import PAD, LabelledRegion, find_regions, number_tissues
from core.smoothing.smooth import smooth

MOST_SURFACES = 64
WIDEST_GAP = 0.25  # of the smallest side of a voxel: both surfaces stay on their own side of it
SPARE = 1.01  # the gap is held this much wider until the last step: distances are sums in float64
ROOM = 0.02  # of the smallest side of a voxel, besides the gap, at first: faces that are joined need room to bend
SMOOTHING_WITHIN = 0.3  # of the smallest side of a voxel
TIGHTER = (0.25, 0.4)  # where a surface crosses itself after rounding, its vertices stay farther from voxel centres
NOWHERE = MeshReference(href="/v1/meshes/00000000-0000-0000-0000-000000000000")  # surfaces are handed over, not referred to


@dataclass(frozen=True, eq=False, slots=True)
class Segmented:
    """A surface and the voxels it stands for.

    mesh: exact in float32. voxels_mm3: volume of the voxels, cavities that were filled among them. labelled, filled, dropped:
    voxels of the labels that stayed, of cavities that were filled, of islands that went. islands: their number. sealed: voxels a
    tissue took from those it encloses, where it would have been open across edges of voxels.
    at_border: voxels that lie at the border of the volume, where the surface is cut off.
    """

    mesh: Mesh
    voxels_mm3: float
    labelled: int
    filled: int
    dropped: int
    islands: int
    sealed: int
    at_border: int


def segment(volume: LabelVolume, asked: SegmentParameters, min_gap_mm: float, run: RunContext = SILENT) -> dict[str, Segmented]:
    """One surface for each name, in the order of the labels.

    Promises: closed, manifold, outward, free of self-intersection (exact), `min_gap_mm` apart; one piece each with `islands`
              `keep_largest` and `cavities` `fill`. Coordinates exact in float32. Same input, same result.
    Raises:   InputError `volume.no_labels`, `segment.*`; InternalError `segment.not_proven`.
    Source:   docs/algorithms/segmentation.md.
    """
    names = name_labels(volume, asked)
    _require_gap(volume, min_gap_mm)
    stage = run.stage("segment: regions", 0.0, 0.1)
    numbers, tissues = number_tissues(volume.labels, names)
    least = asked.min_island_mm3 / volume.voxel_mm3()
    held = _find_held(tissues, asked)
    regions = find_regions(numbers, tissues, asked.islands, least, asked.cavities, held)
    if missing := sorted(set(tissues) - {region.name for region in regions}):
        raise InputError(
            "segment.nothing_left", f"no piece of {', '.join(missing)} has {asked.min_island_mm3:g} mm³", missing=len(missing)
        )
    stage.advance(1.0, f"{len(regions)} tissues")
    stage = run.stage("segment: borders", 0.1, 0.3)
    borders = balance(volume, find_borders(volume, numbers, regions))
    stage.advance(1.0, f"{sum(len(border.faces) for border in borders):,} faces")
    stage = run.stage("segment: apart", 0.3, 0.4)
    first_gap_mm = SPARE**3 * min_gap_mm + ROOM * float(volume.voxel_mm().min())
    borders = _free_of_crossings(volume, give_way(volume, borders, first_gap_mm, stage), stage)
    first = {border.name: border.mesh(volume) for border in borders}
    meshes = _refined(first, volume, asked, min_gap_mm, run.stage("segment: surfaces", 0.4, 1.0))
    return {region.name: _segmented(region, meshes[region.name], volume) for region in regions}


def name_labels(volume: LabelVolume, asked: SegmentParameters) -> dict[int, str]:
    """Label -> name of its surface, ascending, for the labels that become one.

    Raises: InputError `volume.no_labels`, `segment.label_missing`, `segment.too_many_surfaces`.
    """
    counts = volume.counts()
    if not counts:
        raise InputError("volume.no_labels", f"all {volume.labels.size:,} voxels of the volume are 0: nothing is labelled")
    wanted = {int(label): name for label, name in asked.names.items()}
    found = ", ".join(str(label) for label in list(counts)[:20])
    if absent := sorted(set(wanted) - set(counts)):
        raise InputError(
            "segment.label_missing",
            f"no voxel has the label {', '.join(str(label) for label in absent[:20])}; the volume has {found}",
            labels=len(absent),
        )
    names = {label: wanted.get(label, f"label_{label}") for label in counts if label in wanted or asked.includes_others}
    surfaces = len(set(names.values()))
    if surfaces > MOST_SURFACES:
        raise InputError(
            "segment.too_many_surfaces",
            f"{surfaces} labels would be {surfaces} surfaces, {MOST_SURFACES} are the most; name those that are wanted",
            surfaces=surfaces,
            most=MOST_SURFACES,
        )
    return names


def _find_held(tissues: tuple[str, ...], asked: SegmentParameters) -> dict[str, tuple[str, ...]]:
    """Surface -> all that shall lie inside of it. Raises: InputError `segment.unknown_surface`."""
    if unknown := sorted({*asked.inside, *asked.inside.values()} - set(tissues)):
        raise InputError(
            "segment.unknown_surface",
            f"inside names {', '.join(unknown)}; the surfaces are {', '.join(tissues)}",
            unknown=len(unknown),
        )
    return {holder: tuple(name for name in tissues if holder in asked.holders_of(name)) for holder in asked.inside.values()}


def _require_gap(volume: LabelVolume, min_gap_mm: float) -> None:
    widest = WIDEST_GAP * float(volume.voxel_mm().min())
    if min_gap_mm > widest:
        raise InputError(
            "segment.gap_too_wide",
            f"a gap of {min_gap_mm:g} mm is asked; voxels of {volume.voxel_mm().min():.4g} mm allow {widest:.4g} mm at most",
            min_gap_mm=min_gap_mm,
            widest_mm=widest,
        )


def _free_of_crossings(volume: LabelVolume, borders: tuple[Border, ...], run: RunContext) -> tuple[Border, ...]:
    """In exact numbers no border crosses itself; rounding may bring faces together that were next to each other."""
    clean = []
    for border in borders:
        tried = border
        for nearest in (*TIGHTER, None):
            mesh = tried.mesh(volume)
            crossing = len(find_intersecting_faces(mesh.vertices, mesh.faces))
            if not crossing:
                break
            if nearest is None:
                raise InternalError(
                    "segment.not_proven", f"{border.name} crosses itself at {crossing} pairs of faces", crossing=crossing
                )
            run.log(f"{border.name}: {crossing} pairs of faces cross after rounding; drawn to the middle between voxels")
            tried = border.with_share(border.share, nearest)
        clean.append(tried)
    return tuple(clean)


def _refined(
    meshes: Mapping[str, Mesh], volume: LabelVolume, asked: SegmentParameters, min_gap_mm: float, run: RunContext
) -> Mapping[str, Mesh]:
    """Fewer and better triangles, and without what is left of the steps."""
    made = dict(meshes)
    if asked.faces_share < 1.0:
        thin = DecimateInputs(mesh=NOWHERE, method="quadric", target_ratio=asked.faces_share, min_gap_mm=SPARE**2 * min_gap_mm)
        made = {name: each.mesh for name, each in decimate(made, thin, run.stage("segment: fewer faces", 0.0, 0.6)).items()}
    within = SMOOTHING_WITHIN * float(volume.voxel_mm().min())
    if asked.smoothing:
        even = SmoothInputs(
            mesh=NOWHERE,
            method="taubin",
            iterations=asked.smoothing,
            stop="iterations",
            max_shift_mm=within,
            min_gap_mm=SPARE * min_gap_mm,
        )
        made = {name: each.mesh for name, each in smooth(made, even, run.stage("segment: even", 0.6, 0.8)).items()}
    shapely = SmoothInputs(mesh=NOWHERE, method="hc", along_surface=True, max_shift_mm=within, min_gap_mm=min_gap_mm)
    return {name: each.mesh for name, each in smooth(made, shapely, run.stage("segment: triangles", 0.8, 1.0)).items()}


def _segmented(region: LabelledRegion, mesh: Mesh, volume: LabelVolume) -> Segmented:
    voxels = np.argwhere(region.inside) + region.low - PAD
    last = np.array(volume.labels.shape) - 1
    return Segmented(
        mesh=mesh,
        voxels_mm3=float(region.inside.sum()) * volume.voxel_mm3(),
        labelled=region.labelled,
        filled=region.filled,
        dropped=region.dropped,
        islands=region.islands,
        sealed=region.sealed,
        at_border=int(((voxels == 0) | (voxels == last)).any(axis=1).sum()),
    )
