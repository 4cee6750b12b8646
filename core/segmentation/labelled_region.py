"""The voxels of one tissue: which belong to it, after small islands went and cavities were filled."""

from __future__ import annotations

from collections.abc import Mapping
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
    numbers: NDArray[np.uint16], tissues: tuple[str, ...], islands: Islands, least_voxels: float, cavities: Cavities
) -> tuple[LabelledRegion, ...]:
    """The tissues as regions; voxels of islands that go become 0 in `numbers`, which is changed.

    Pieces hang together, and enclose, along the edges of the tetrahedral grid: then the surface of each has as many pieces.
    """
    boxes = [(slice(0, 1),) * 3 if box is None else box for box in find_objects(numbers, max_label=len(tissues))]
    gone = [_drop_islands(numbers[box], number, islands, least_voxels) for number, box in enumerate(boxes, start=1)]
    sealed = [0] * len(tissues)
    if cavities == "fill":
        sealed = [_seal(numbers[box], number) for number, box in enumerate(boxes, start=1)]
        # a voxel that was given away may have been a bridge
        again = [_drop_islands(numbers[box], number, islands, least_voxels) for number, box in enumerate(boxes, start=1)]
        gone = [(a + c, b + d) for (a, b), (c, d) in zip(gone, again, strict=True)]
    regions = []
    for number, (name, box, (dropped, count)) in enumerate(zip(tissues, boxes, gone, strict=True), start=1):
        inside = np.pad(numbers[box] == number, PAD)
        labelled = int(inside.sum())
        low = np.array([side.start - PAD for side in box])
        if cavities == "fill":
            inside = binary_fill_holes(inside, structure=NEIGHBOURS)
        if labelled:
            filled = int(inside.sum()) - labelled
            regions.append(LabelledRegion(name, low, inside, labelled, filled, dropped, count, sealed[number - 1]))
    return tuple(regions)


def _seal(part: NDArray[np.uint16], number: int) -> int:
    """Give a tissue that encloses others at the sides of voxels, but not at their edges and corners, what it lacks of them.

    The voxels it encloses that touch the outside across an edge or corner become its own; their number. Without them what
    lies inside a sheet of one voxel would reach through it on the tetrahedral grid.
    """
    inside = np.pad(part == number, 1)
    filled = binary_fill_holes(inside)
    if (filled == inside).all():
        return 0
    lacking = filled & ~inside & binary_dilation(~filled, structure=NEIGHBOURS)
    part[lacking[1:-1, 1:-1, 1:-1]] = number
    return int(lacking.sum())


def _drop_islands(part: NDArray[np.uint16], number: int, islands: Islands, least_voxels: float) -> tuple[int, int]:
    """Voxels and pieces that went from the part of the volume around one tissue."""
    if islands == "keep_all":
        return 0, 0
    pieces, count = label(part == number, structure=NEIGHBOURS)
    if count < 2 and islands == "keep_largest":
        return 0, 0
    sizes = np.bincount(pieces.ravel())
    sizes[0] = 0
    keep = sizes >= least_voxels if islands == "keep_above" else np.arange(len(sizes)) == np.argmax(sizes)
    drop = ~keep
    drop[0] = False
    part[drop[pieces]] = 0
    return int(sizes[drop].sum()), int(drop.sum())
