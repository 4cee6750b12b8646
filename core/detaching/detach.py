"""Set parts of a body apart that are grown together where they touch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.detaching.contacts import Contact, find_contacts
from core.detaching.opening import Opening, open_contact, within
from core.detaching.prove_detached import count_pieces, measure_genus, prove_detached
from core.detaching.refusal import contact_findings, words
from core.detaching.region_grid import RegionGrid, cube_size_mm, fill_grid
from core.detaching.sheet import draw_sheet
from core.detaching.unite import unite
from core.errors import InputError
from core.geometry.quality import side_lengths
from core.geometry.volume import signed_volumes
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.detach import ContactRegion, DetachSettings

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

ACROSS = 5  # triangles at least across the smallest contact
WALL_SHARE = 0.5  # of the width: no triangle of a sheet is smaller
VOXEL_AREA = 1.5  # faces of cubes a surface shows, over its area, on average over its directions


@dataclass(frozen=True, eq=False, slots=True)
class OpenedContact:
    """What became of one contact. point_mm: deepest place of it. depth_mm: there; part_depth_mm: of the thinner part.

    area_mm2, middle_mm, normal: of the contact, the normal towards the thinner part. end_mm: length of the slit's end inside
    of the body, 0 if it comes out everywhere. gap_mm, mean_gap_mm: between the new surfaces. volume_mm3: that the body lost.
    faces_removed, faces_added: of the skin. genus_before, genus_after: handles of the skin."""

    region: str
    point_mm: tuple[float, float, float]
    depth_mm: float
    part_depth_mm: float
    area_mm2: float
    middle_mm: tuple[float, float, float]
    normal: tuple[float, float, float]
    end_mm: float
    gap_mm: float
    mean_gap_mm: float
    volume_mm3: float
    faces_removed: int
    faces_added: int
    genus_before: int
    genus_after: int


@dataclass(frozen=True, eq=False, slots=True)
class Detached:
    """mesh: the skin with all contacts open. new: (F,) True for faces the skin did not have. pieces: closed surfaces.

    crossing: pairs of faces (K, 2) of the skin as it came that ran through each other, before its parts were united."""

    mesh: Mesh
    new: Flags
    contacts: tuple[OpenedContact, ...]
    pieces: int
    crossing: NDArray[np.int64]


def detach(skin: Mesh, settings: DetachSettings, run: RunContext = SILENT) -> Detached:
    """Open every contact in the regions, along the smallest surface that separates the parts.

    Needs:    closed, manifold, outward, exact in float32. Where it runs through itself it is united first.
    Promises: closed, manifold, outward, free of self-intersection (exact), the pieces asked for; the gap at least
              `settings.gap_mm` between the new walls; no face with a corner outside of the regions changes, bit for bit,
              but for those that ran through each other.
    Raises:   InputError `region.outside_mesh`, `detach.no_contact`, `detach.not_one_contact`, `detach.region_cuts_too_much`,
              `detach.no_room`, `detach.not_opened`, `detach.still_attached`, `heal.*`; InternalError
              `detach.not_proven`.
    Source:   thesis 5.3, where triangles were removed, the edges moved apart and the holes closed by hand."""
    united = unite(skin, run.stage("detach: crossings", 0.0, 0.1))
    mesh: Mesh = united.mesh
    opened: list[OpenedContact] = []
    for number, region in enumerate(settings.regions):
        low, high = (0.1 + 0.9 * (number + end) / len(settings.regions) for end in (0, 1))
        step = run.stage(f"detach: {region.name}", low, high)
        mesh, found = _open_region(mesh, region, settings, step)
        opened += found
    pieces = count_pieces(mesh)
    if pieces != settings.pieces:
        raise _other_pieces(pieces, settings, opened)
    new = prove_detached(united.mesh, mesh, [(region.box_mm.min, region.box_mm.max) for region in settings.regions])
    return Detached(mesh, new, tuple(opened), pieces, united.crossing)


def _open_region(
    mesh: Mesh, region: ContactRegion, settings: DetachSettings, run: RunContext
) -> tuple[Mesh, list[OpenedContact]]:
    low, high = np.array(region.box_mm.min), np.array(region.box_mm.max)
    inner = within(mesh.vertices, low, high)[mesh.faces].all(axis=1)
    edge_mm = float(np.median(side_lengths(mesh.vertices, mesh.faces[inner]))) if inner.any() else float((high - low).max())
    grid = fill_grid(mesh, low, high, cube_size_mm(low, high, edge_mm))
    run.advance(0.1, f"{int(grid.solid.sum())} cubes of {grid.size_mm:.3g} mm inside of the body")
    contacts = find_contacts(mesh, grid, region, settings.narrowing)
    opened = []
    for number, contact in enumerate(contacts):
        run.advance(0.4 + 0.6 * number / len(contacts), f"contact at {words(contact.point_mm)} mm")
        mesh, account = _open(mesh, grid, contact, region, settings, edge_mm)
        run.log(f"{account.area_mm2 / 100:.3g} cm² opened to {account.gap_mm:.3g} mm")
        opened.append(account)
    return mesh, opened


def _open(
    mesh: Mesh, grid: RegionGrid, contact: Contact, region: ContactRegion, settings: DetachSettings, edge_mm: float
) -> tuple[Mesh, OpenedContact]:
    low, high = np.array(region.box_mm.min), np.array(region.box_mm.max)
    area = _area_mm2(contact, grid.size_mm)
    if area > 100.0 * settings.max_contact_cm2:
        message = (
            f"the smallest cut through the contact in the region '{region.name}' is {area / 100:.3g} cm² large, "
            f"`max_contact_cm2` allows {settings.max_contact_cm2:g}: the region holds more than a contact"
        )
        raise _refused("detach.region_cuts_too_much", contact, message, area)
    finest = max(WALL_SHARE * settings.gap_mm, grid.size_mm * WALL_SHARE)
    edge_mm = max(min(edge_mm, area**0.5 / ACROSS), finest)
    may_change = np.asarray(within(mesh.vertices, low, high)[mesh.faces].all(axis=1))
    drawn = False
    for halfway in (True, False):
        sheet = draw_sheet(mesh, grid, contact.side, settings.gap_mm, edge_mm, may_change, halfway=halfway)
        if sheet is None or not sheet.inside.any():
            continue
        drawn = True
        made = open_contact(mesh, sheet, settings.gap_mm, low, high)
        if made is not None:
            return made.mesh, _account(mesh, made, contact, region)
    raise _not_opened(contact, region, area, drawn)


def _not_opened(contact: Contact, region: ContactRegion, area_mm2: float, drawn: bool) -> InputError:
    if drawn:
        message = (
            f"no gap along the contact in the region '{region.name}' left a skin free of self-intersection: the parts are grown "
            "together in too many folds there; move the walls of the box away from them"
        )
        return _refused("detach.not_opened", contact, message, area_mm2)
    message = (
        f"there is no room in the region '{region.name}' to open the contact: faces of the skin there reach out of the box, or "
        "what is narrow there is no contact; put the box around the contact and the thick middle of both parts"
    )
    return _refused("detach.no_room", contact, message, area_mm2)


def _area_mm2(contact: Contact, size_mm: float) -> float:
    """Of the cut, from the sides of cubes between the parts."""
    side, sides = contact.side, 0
    for axis in range(3):
        first, second = np.delete(side, -1, axis=axis), np.delete(side, 0, axis=axis)
        sides += int(((first + second == 3) & (first > 0) & (second > 0)).sum())
    return sides * size_mm**2 / VOXEL_AREA


def _account(before: Mesh, made: Opening, contact: Contact, region: ContactRegion) -> OpenedContact:
    volumes = [
        float(signed_volumes(mesh.vertices, mesh.faces, np.zeros(len(mesh.faces), dtype=np.int64))[0])
        for mesh in (before, made.mesh)
    ]
    return OpenedContact(
        region.name,
        contact.point_mm,
        contact.core.pass_mm,
        contact.core.depth_mm,
        made.area_mm2,
        made.middle_mm,
        made.normal,
        made.end_mm,
        made.gap_mm,
        made.mean_gap_mm,
        volumes[0] - volumes[1],
        len(before.faces) - made.kept,
        len(made.mesh.faces) - made.kept,
        measure_genus(before),
        measure_genus(made.mesh),
    )


def _refused(code: str, contact: Contact, message: str, area_mm2: float) -> InputError:
    return InputError(
        code, message, findings=contact_findings(code, [contact.point_mm], message), contact_cm2=round(area_mm2 / 100, 3)
    )


def _other_pieces(pieces: int, settings: DetachSettings, opened: list[OpenedContact]) -> InputError:
    places = [contact.point_mm for contact in opened]
    if pieces > settings.pieces:
        code = "detach.region_cuts_too_much"
        message = (
            f"opening the contacts leaves {pieces} pieces, `pieces` asks for {settings.pieces}: a part would be cut off. Make "
            "the box smaller, so that it holds the contact but not the place where the parts belong together"
        )
    else:
        code = "detach.still_attached"
        message = f"with the contacts open there are {pieces} pieces, `pieces` asks for {settings.pieces}: they meet elsewhere"
    return InputError(code, message, findings=contact_findings(code, places, message), pieces=pieces, wanted=settings.pieces)
