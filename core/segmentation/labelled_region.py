"""The voxels of one tissue: which belong to it, after small islands went and cavities were filled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_fill_holes, find_objects, label

from core.segmentation.tetrahedral_grid import NEIGHBOURS

Islands = Literal["keep_largest", "keep_above", "keep_all"]
Cavities = Literal["fill", "keep"]

PAD = 4  # voxels around the volume, and around each tissue: the filter of its field reaches so far


@dataclass(frozen=True, eq=False, slots=True)
class LabelledRegion:
    """A tissue in the grid of all.

    low: (3,) its first voxel there. inside: (I, J, K) with `PAD` voxels of nothing around. labelled: voxels of the labels that
    stayed, filled: voxels of cavities, dropped: voxels of islands that went, in `islands` pieces. sealed: voxels it was given so
    that it encloses what it encloses at the sides of voxels.
    """

    name: str
    low: NDArray[np.int64]
    inside: NDArray[np.bool_]
    labelled: int
    filled: int
    dropped: int
    islands: int
    sealed: int


def number_tissues(labels: NDArray[np.uint16], names: Mapping[int, str]) -> tuple[NDArray[np.uint16], tuple[str, ...]]:
    """The volume with `PAD` voxels of nothing around it, and a tissue's number instead of its label: 1 for the first name.

    names: label -> tissue; labels that share a name are one tissue, labels without one are nothing.
    """
    tissues = tuple(dict.fromkeys(names.values()))
    table = np.zeros(int(max(labels.max(initial=0), max(names))) + 1, dtype=np.uint16)
    for value, name in names.items():
        table[value] = tissues.index(name) + 1
    return np.pad(table[labels], PAD), tissues


def find_regions(
    numbers: NDArray[np.uint16],
    tissues: tuple[str, ...],
    islands: Islands,
    least_voxels: float,
    cavities: Cavities,
    held: Mapping[str, tuple[str, ...]],
) -> tuple[LabelledRegion, ...]:
    """The tissues as regions; voxels of islands that go become 0 in `numbers`, which is changed.

    held: tissue -> all that shall lie inside of it. Pieces hang together, and enclose, along the edges of the tetrahedral grid:
    then the surface of each has as many pieces.
    """
    families = [_family(name, tissues, held) for name in tissues]
    boxes = _boxes(numbers, families)
    outermost = sorted(range(len(tissues)), key=lambda place: (-len(families[place]), place))
    gone, sealed = [(0, 0)] * len(tissues), [0] * len(tissues)
    for place in outermost:
        gone[place] = _drop_islands(numbers[boxes[place]], families[place], islands, least_voxels)
    if cavities == "fill":
        for place in outermost:
            sealed[place] = _seal(numbers[boxes[place]], families[place])
        for place in outermost:  # a voxel that was given away may have been a bridge
            again = _drop_islands(numbers[boxes[place]], families[place], islands, least_voxels)
            gone[place] = (gone[place][0] + again[0], gone[place][1] + again[1])
    regions = []
    for place, (name, box) in enumerate(zip(tissues, boxes, strict=True)):
        labelled = int((numbers[box] == place + 1).sum())
        inside = np.pad(np.isin(numbers[box], families[place]), PAD)
        if cavities == "fill":
            inside = binary_fill_holes(inside, structure=NEIGHBOURS)
        if labelled:
            low = np.array([side.start - PAD for side in box])
            filled = int(inside.sum()) - labelled
            regions.append(LabelledRegion(name, low, inside, labelled, filled, *gone[place], sealed[place]))
    return tuple(regions)


def _family(name: str, tissues: tuple[str, ...], held: Mapping[str, tuple[str, ...]]) -> tuple[int, ...]:
    """Numbers of a tissue, first, and of all that shall lie inside of it."""
    return tuple(tissues.index(each) + 1 for each in (name, *held.get(name, ())))


def _boxes(numbers: NDArray[np.uint16], families: Sequence[tuple[int, ...]]) -> list[tuple[slice, slice, slice]]:
    """Around each family; one voxel for one that is not there."""
    found = find_objects(numbers, max_label=len(families))
    boxes = []
    for family in families:
        own = [found[number - 1] for number in family if found[number - 1] is not None]
        sides = [
            (min(box[axis].start for box in own), max(box[axis].stop for box in own)) if own else (0, 1) for axis in range(3)
        ]
        boxes.append((slice(*sides[0]), slice(*sides[1]), slice(*sides[2])))
    return boxes


def _seal(part: NDArray[np.uint16], family: tuple[int, ...]) -> int:
    """Give a tissue, the first of its family, what it lacks to enclose the others, and what it encloses at the sides of voxels
    but not at their edges and corners; how many voxels.

    These are the voxels that touch the outside across a side, edge or corner: without them what lies inside a sheet of one voxel
    would reach through it on the tetrahedral grid.
    """
    own = np.pad(part == family[0], 1)
    together = np.pad(np.isin(part, family), 1)
    filled = binary_fill_holes(together)
    if (filled == own).all():
        return 0
    lacking = filled & ~own & binary_dilation(~filled, structure=NEIGHBOURS)
    part[lacking[1:-1, 1:-1, 1:-1]] = family[0]
    return int(lacking.sum())


def _drop_islands(part: NDArray[np.uint16], family: tuple[int, ...], islands: Islands, least_voxels: float) -> tuple[int, int]:
    """Voxels and pieces that went from the part of the volume around a tissue and what lies inside of it."""
    if islands == "keep_all":
        return 0, 0
    pieces, count = label(np.isin(part, family), structure=NEIGHBOURS)
    if count < 2 and islands == "keep_largest":
        return 0, 0
    sizes = np.bincount(pieces.ravel())
    sizes[0] = 0
    keep = sizes >= least_voxels if islands == "keep_above" else np.arange(len(sizes)) == np.argmax(sizes)
    drop = ~keep
    drop[0] = False
    part[drop[pieces]] = 0
    return int(sizes[drop].sum()), int(drop.sum())
