"""The voxels of one tissue: which belong to it, after small islands went and cavities were filled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_fill_holes, find_objects, label

from core.segmentation.tetrahedral_grid import NEIGHBOURS

Islands = Literal["keep_largest", "keep_above", "keep_all"]
Cavities = Literal["fill", "keep"]

PAD = 4  # voxels around the volume, and around each tissue: the filter of its field reaches so far


@dataclass(frozen=True, eq=False, slots=True)
class LabelledRegion:
    """A tissue in the grid of all.

    low: (3,) its first voxel there. inside: (I, J, K) with `PAD` voxels of nothing around. labelled: voxels of the labels that
    stayed, filled: voxels of cavities, dropped: voxels of islands that went, in `islands` pieces.
    """

    name: str
    low: NDArray[np.int64]
    inside: NDArray[np.bool_]
    labelled: int
    filled: int
    dropped: int
    islands: int


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
    boxes = find_objects(numbers, max_label=len(tissues))
    gone = []
    for number, box in enumerate(boxes, start=1):
        if box is not None:
            gone.append(_drop_islands(numbers[box], number, islands, least_voxels))
        else:
            gone.append((0, 0))
    regions = []
    for number, (name, box, (dropped, count)) in enumerate(zip(tissues, boxes, gone, strict=True), start=1):
        if box is None:
            continue
        inside = np.pad(numbers[box] == number, PAD)
        labelled = int(inside.sum())
        low = np.array([side.start - PAD for side in box])
        if cavities == "fill":
            inside = binary_fill_holes(inside, structure=NEIGHBOURS)
        if labelled:
            regions.append(LabelledRegion(name, low, inside, labelled, int(inside.sum()) - labelled, dropped, count))
    return tuple(regions)


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
