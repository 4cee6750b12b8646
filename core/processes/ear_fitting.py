"""Ears found, canals cut into the skin, regions made of both: what `ears` and `prepare` do before they make layers."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from core.ears.canal import make_canal
from core.ears.concha import find_concha
from core.ears.cut_canals import cut_canals
from core.ears.find_ears import find_ears
from core.ears.remesh_seam import remesh_seams
from core.geometry.body_frame import BodyFrame, find_body_frame
from core.geometry.cut_surface import SKIN
from core.geometry.seams import RemeshedSurface
from core.io.naming import make_unique
from core.mesh import Mesh
from core.processes.ear_boxes import rounded_box
from core.processes.named_input import NamedInput
from core.reports.figures.ear_views import EarRegionView, draw_ears
from core.reports.figures.figure import Figure
from core.reports.palette import tissue_colours
from core.run import RunContext
from core.schema.ears import EarsInputs
from core.schema.finding import Finding, Place, Severity
from core.schema.shells import Region
from core.shells.nested_shells import Shell
from core.shells.thickness import is_limited, is_on_target, vertex_areas
from core.validation.requirements import require_fit_skin

CANAL_MARGIN_MM = 0.5
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9_-]+")
FOUND = "Both ears were found by shape, as the thin sheets that stand out at the sides of the head. "
CUT = (
    "Canals were subtracted as solids in double precision and the seams remeshed locally by splits, collapses, flips and "
    "tangential smoothing; no vertex there lies farther than {moved:.2f} mm from the surfaces given. "
)
THINNER = (
    "Inside the ears' boxes the layers have depths of their own, blended into the others' over {blend:g} mm, where [3] "
    "(6.4) cut the ears out of thinner shells and set them in. "
)


@dataclass(frozen=True, eq=False, slots=True)
class FittedEars:
    """skin: with the canals, and which faces are their walls. ears, walls: boxes with depths. canals: names of those cut."""

    skin: RemeshedSurface
    ears: tuple[Region, ...]
    walls: tuple[Region, ...]
    canals: tuple[str, ...]

    @property
    def regions(self) -> tuple[Region, ...]:
        """Of ears first, then of the walls of canals."""
        return (*self.ears, *self.walls)


def fit_ears(
    inputs: EarsInputs, skin: Mesh, solids: Sequence[NamedInput], run: RunContext, seen_on: Mesh | None = None
) -> FittedEars:
    """Ears and canals of a skin that `require_fit_skin` accepts, exact in float32.

    seen_on: the same skin as it was before it was thinned out, to find ears on: the pinna is the first that coarse faces blur.
    Raises: InputError `ears.*`, `canal.*`; InternalError `canal.seam_not_proven`.
    """
    detailed = skin if seen_on is None else seen_on
    look = run.stage("ears", 0.0, 0.2)
    ears = _ear_regions(inputs, detailed)
    look.advance(1.0, "; ".join(_box_words(ear) for ear in ears))
    canals = _canals(inputs, detailed, find_body_frame(detailed), solids)
    cut = _with_canals(skin, canals, run.stage("canals", 0.2, 1.0))
    return FittedEars(cut, ears, _wall_regions(cut, list(canals), ears), tuple(canals))


def ear_findings(fitted: FittedEars, shells: tuple[Shell, ...]) -> tuple[Finding, ...]:
    """How the layers keep their depths in each box."""
    return tuple(_ear_finding(region, shells) for region in fitted.regions)


def ear_changes(fitted: FittedEars) -> tuple[dict[str, Any], ...]:
    """What cutting did to the skin; nothing without canals."""
    if not fitted.canals:
        return ()
    skin = fitted.skin
    return (
        {
            "mesh": "skin",
            "what": f"canals cut out: {', '.join(fitted.canals)}; seams remeshed",
            "new_faces": len(skin.mesh.faces) - skin.kept,
            "unchanged_faces": skin.kept,
            "farthest_from_given_surfaces_mm": round(skin.moved_mm, 4),
            "lowest_quality_of_new_faces": round(skin.lowest_quality, 4),
        },
    )


def ear_methods(fitted: FittedEars, inputs: EarsInputs) -> str:
    """Citable; [3] is the thesis."""
    return (
        (FOUND if inputs.ears == "auto" else "")
        + (CUT.format(moved=fitted.skin.moved_mm) if fitted.canals else "")
        + THINNER.format(blend=inputs.blend_mm)
    )


def draw_fitted_ears(fitted: FittedEars, frame: BodyFrame, surfaces: Mapping[str, Mesh]) -> tuple[Figure, ...]:
    """Views and sections; surfaces in nesting order, the skin of `fitted` among them."""
    wall = fitted.skin.piece != SKIN
    return draw_ears(surfaces, tissue_colours(list(surfaces)), frame, _views(fitted.ears, fitted.walls, frame), wall)


def _ear_regions(inputs: EarsInputs, skin: Mesh) -> tuple[Region, ...]:
    """The boxes found or given, with the depths that hold in them."""
    if inputs.ears == "auto":
        return tuple(
            Region(name=ear.name, box_mm=rounded_box(ear.low, ear.high), depths_mm=inputs.ear_depths_mm, blend_mm=inputs.blend_mm)
            for ear in find_ears(skin)
        )
    return tuple(
        Region(
            name=ear.name,
            box_mm=ear.box_mm,
            depths_mm=inputs.ear_depths_mm if ear.depths_mm is None else ear.depths_mm,
            blend_mm=inputs.blend_mm if ear.blend_mm is None else ear.blend_mm,
        )
        for ear in inputs.ears
    )


def _canals(inputs: EarsInputs, skin: Mesh, frame: BodyFrame, solids: Sequence[NamedInput]) -> dict[str, Mesh]:
    """Name -> solid, exact in float32; those sent, or one of the shape asked for in each ear found."""
    shape = inputs.generate_canals
    if shape is None:
        names = make_unique(_as_region_name(solid.name) for solid in solids)
        return {name: solid.mesh.rounded_to_float32() for name, solid in zip(names, solids, strict=True)}
    return {
        f"{ear.name}_canal": make_canal(
            skin.vertices[find_concha(skin, ear, frame.up)],
            -ear.outward,
            frame.up,
            radius_mm=shape.radius_mm,
            length_mm=shape.length_mm,
            bend_mm=shape.bend_mm,
        ).rounded_to_float32()
        for ear in find_ears(skin)
    }


def _with_canals(skin: Mesh, canals: Mapping[str, Mesh], run: RunContext) -> RemeshedSurface:
    if not canals:
        return RemeshedSurface(skin, np.full(len(skin.faces), SKIN), len(skin.faces), 0.0, 1.0)
    return run.checkpoint("ears: canals", lambda: _cut(skin, canals, run), skin, canals)


def _cut(skin: Mesh, canals: Mapping[str, Mesh], run: RunContext) -> RemeshedSurface:
    cut = cut_canals(skin, canals)
    run.advance(0.5, f"{len(canals)} canals cut, {len(cut.mesh.faces)} faces")
    remeshed = remesh_seams(cut, skin, tuple(canals.values()))
    require_fit_skin(remeshed.mesh, "skin")
    run.advance(1.0, f"seams remeshed, lowest quality {remeshed.lowest_quality:.2f}")
    return remeshed


def _wall_regions(skin: RemeshedSurface, canals: list[str], ears: tuple[Region, ...]) -> tuple[Region, ...]:
    """A region for the wall of each canal, with the depths of the ear it is nearest to."""
    regions = []
    for number, name in enumerate(make_unique([*(ear.name for ear in ears), *canals])[len(ears) :]):
        wall = skin.mesh.vertices[np.unique(skin.mesh.faces[skin.piece == number])]
        low, high = wall.min(axis=0) - CANAL_MARGIN_MM, wall.max(axis=0) + CANAL_MARGIN_MM
        middles = [(np.array(ear.box_mm.min) + np.array(ear.box_mm.max)) / 2 for ear in ears]
        ear = ears[int(np.argmin([np.linalg.norm(middle - (low + high) / 2) for middle in middles]))]
        regions.append(ear.model_copy(update={"name": name, "box_mm": rounded_box(low, high)}))
    return tuple(regions)


def _as_region_name(text: str) -> str:
    """The name of an upload in letters that the name of a region may have."""
    return _NOT_IN_NAMES.sub("_", text).strip("_-")[:60] or "canal"


def _ear_finding(region: Region, shells: tuple[Shell, ...]) -> Finding:
    """What the box is and how the layers keep their depths inside it, so that a reader can confirm it."""
    words = []
    for shell in shells:
        vertices, areas = shell.mesh.vertices, vertex_areas(shell.mesh)
        inside = ((vertices >= region.box_mm.min) & (vertices <= region.box_mm.max)).all(axis=1)
        total = max(float(areas[inside].sum()), 1e-12)
        kept, limited = (float(areas[inside & chosen].sum()) / total for chosen in (is_on_target(shell), is_limited(shell)))
        depth = region.depths_mm.get(shell.name)
        if depth is not None:
            words.append(
                f"{shell.name} {depth:g} mm on target on {100 * kept:.1f} % of its area there, limited by anatomy on "
                f"{100 * limited:.1f} %"
            )
    x, y, z = (float((low + high) / 2) for low, high in zip(region.box_mm.min, region.box_mm.max, strict=True))
    return Finding(
        code="ears.region",
        severity=Severity.INFO,
        message=f"{_box_words(region)}: {'; '.join(words)}",
        count=1,
        places=(Place(mesh="skin", point_mm=(x, y, z)),),
    )


def _views(ears: tuple[Region, ...], walls: tuple[Region, ...], frame: BodyFrame) -> list[EarRegionView]:
    """Each ear with the canals that open in it, cut at the height of these or in its middle."""
    views = []
    for ear in ears:
        low, high = np.array(ear.box_mm.min), np.array(ear.box_mm.max)
        boxes = [(np.array(wall.box_mm.min), np.array(wall.box_mm.max)) for wall in walls]
        meeting = [box for box in boxes if (box[0] <= high).all() and (box[1] >= low).all()] or [(low, high)]
        lows, highs = (np.array(corners) for corners in zip(*meeting, strict=True))
        at = float((lows.min(axis=0) + highs.max(axis=0)) @ frame.up / 2)
        views.append(
            EarRegionView(ear.name, low, high, np.vstack([lows, low]).min(axis=0), np.vstack([highs, high]).max(axis=0), at)
        )
    return views


def _box_words(region: Region) -> str:
    sizes = (high - low for low, high in zip(region.box_mm.min, region.box_mm.max, strict=True))
    corner = ", ".join(f"{value:g}" for value in region.box_mm.min)
    return f"{region.name} {' × '.join(f'{size:.1f}' for size in sizes)} mm from ({corner}) mm"
