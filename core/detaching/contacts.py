"""The contacts in a region: which parts there are, and the cut between each and the rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.detaching.cheapest_cut import find_least_cut, find_seeds
from core.detaching.cores import Core, find_cores
from core.detaching.creases import Creases, find_creases
from core.detaching.refusal import contact_findings, words
from core.detaching.region_grid import RegionGrid
from core.errors import InputError
from core.mesh import Mesh
from core.schema.detach import ContactRegion

Ints = NDArray[np.int64]
LEAST_RISE_CUBES = 2.0  # a core must rise above its pass by more than the stairs of the cubes do
BORDER_SHARE = 1.0  # of the depth of the pass: what a mm of border beside a crease costs, in mm² of cut
DEEPEST = 0.95  # of the thinner part: from here on nobody can tell two parts by their depth ...
CREASE_SHARE = 2.0  # ... and above `narrowing` only with so many depths of the pass as sharp valley around it
CREASE_REACH = 1.3  # depths of the pass around it


@dataclass(frozen=True, eq=False, slots=True)
class Contact:
    """side: (X, Y, Z) 1 in the part, 2 in what it touches, 0 elsewhere. core, point_mm: deepest place of the part, and the
    deepest of the contact."""

    side: NDArray[np.int8]
    core: Core
    point_mm: tuple[float, float, float]


def find_contacts(mesh: Mesh, grid: RegionGrid, region: ContactRegion, narrowing: float) -> tuple[Contact, ...]:
    """As many contacts as the region says it has.

    Raises: InputError `region.outside_mesh`, `detach.no_contact`, `detach.not_one_contact`."""
    if not grid.solid.any():
        raise InputError("region.outside_mesh", f"nothing of the skin lies in the region '{region.name}'", region=region.name)
    depth = grid.depth_mm()
    cores = find_cores(depth, LEAST_RISE_CUBES * grid.size_mm) if np.isfinite(depth).all() else ()
    creases = find_creases(mesh, grid)
    narrow = _narrow_cores(grid, cores, creases, narrowing, region.contacts)
    if len(narrow) != region.contacts:
        raise _other_number(grid, region, cores, narrow, narrowing)
    part = np.zeros(grid.solid.shape, dtype=np.int16)
    part[grid.solid] = 1
    contacts = []
    for core in narrow:
        mine = part == part.ravel()[core.cube]
        seeds = find_seeds(
            np.where(mine, depth, 0.0), core, tuple(other for other in cores if other.cube != core.cube), grid.size_mm
        )
        if not (seeds == 2).any():
            continue
        side = find_least_cut(mine, seeds, creases, BORDER_SHARE * core.pass_mm, grid.size_mm)
        part[side == 1] = part.max() + 1
        contacts.append(Contact(side, core, _place(grid, core.pass_cube)))
    return tuple(contacts)


def _narrow_cores(grid: RegionGrid, cores: tuple[Core, ...], creases: Creases, narrowing: float, wanted: int) -> list[Core]:
    """Those with a contact, the narrowest first. If there are too few, deep ones count, too, that have a crease around them, as
    no wrist and no waist has."""
    passed = sorted((core for core in cores if core.pass_mm > 0.0), key=lambda core: (core.narrowing, core.cube))
    narrow = [core for core in passed if core.narrowing <= narrowing]
    if len(narrow) >= wanted:
        return narrow
    deep = [core for core in passed if narrowing < core.narrowing <= DEEPEST and _is_creased(grid, core, creases)]
    return narrow + deep


def _is_creased(grid: RegionGrid, core: Core, creases: Creases) -> bool:
    length = creases.sharp_length_mm(np.array(_place(grid, core.pass_cube)), CREASE_REACH * core.pass_mm)
    return length >= CREASE_SHARE * core.pass_mm


def _place(grid: RegionGrid, cube: int) -> tuple[float, float, float]:
    x, y, z = grid.middles(np.array(np.unravel_index([cube], grid.solid.shape)).T)[0].tolist()
    return round(x, 3), round(y, 3), round(z, 3)


def _other_number(
    grid: RegionGrid, region: ContactRegion, cores: tuple[Core, ...], narrow: list[Core], narrowing: float
) -> InputError:
    """Too few or too many, with what was seen."""
    places = [_place(grid, core.pass_cube) for core in narrow]
    if narrow:
        message = (
            f"the region '{region.name}' holds {len(narrow)} contacts, {region.contacts} wanted, at "
            f"{', '.join(words(place) for place in places[:8])} mm; make the box smaller, or say how many to open"
        )
        findings = contact_findings("detach.not_one_contact", places, message)
        return InputError("detach.not_one_contact", message, findings=findings, found=len(narrow), wanted=region.contacts)
    passed = [core for core in cores if core.pass_mm > 0.0]
    seen = min(passed, key=lambda core: (core.narrowing, core.cube)) if passed else None
    message = f"no contact in the region '{region.name}': " + (
        f"where its parts meet, the body is {seen.pass_mm:.3g} mm deep, {seen.narrowing:.0%} of the {seen.depth_mm:.3g} mm of "
        f"the thinner part; `narrowing` allows {narrowing:.0%}, or {DEEPEST:.0%} with a crease around the contact"
        if seen
        else "the body there has one part only, parts that do not meet inside of the box, or parts sunk into each other by more "
        f"than the radius of the thinner one (it must be {LEAST_RISE_CUBES * grid.size_mm:.3g} mm deeper than the contact); let "
        "the box hold the thick middle of both parts, and pose parts that are sunk so deep farther apart"
    )
    places = [_place(grid, seen.pass_cube)] if seen else [_place(grid, int(np.flatnonzero(grid.solid)[0]))]
    return InputError("detach.no_contact", message, findings=contact_findings("detach.no_contact", places, message))
