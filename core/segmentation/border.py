"""Vertices of all surfaces on the edges of the grid: where between two voxel centres each lies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from core.geometry.normals import face_areas, vertex_normals
from core.label_volume import LabelVolume
from core.mesh import Mesh
from core.segmentation.labelled_region import PAD, LabelledRegion
from core.segmentation.signed_field import signed_field
from core.segmentation.tetrahedral_grid import surface_between

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Value = TypeVar("Value", np.bool_, np.float32)

NEAREST = 0.1  # share of an edge that a surface keeps from the voxel centres on both sides: sheets of one voxel keep 0.2 of them
SMALLEST_DEPTH = 1e-3  # of a voxel: where the filter took a voxel out of its tissue, the surface comes this near to its centre
BALANCING_STEPS = 8
BALANCED = 1e-4  # of the volume of the voxels


@dataclass(frozen=True, eq=False, slots=True)
class Border:
    """The surface of one tissue on the grid.

    ends: (V, 2, 3) the voxels inside and outside between which each vertex lies, in voxels of the volume. faces: (F, 3), outward.
    share: (V,) of the way from the inner voxel to the outer one. across: (V,) number of the tissue that begins there, or -1.
    crowded: (V,) other surfaces are within two voxels. volume_mm3: of all its voxels.
    """

    name: str
    ends: Ints
    faces: Ints
    share: Floats
    across: Ints
    crowded: NDArray[np.bool_]
    volume_mm3: float

    def mesh(self, volume: LabelVolume) -> Mesh:
        """The surface in mm, exact in float32."""
        way = self.ends[:, 1] - self.ends[:, 0]
        return Mesh.of(volume.places_mm(self.ends[:, 0] + way * self.share[:, None]), self.faces).rounded_to_float32()

    def with_share(self, share: Floats, nearest: float) -> Border:
        """The same surface elsewhere on its edges, never nearer to their ends than `nearest`."""
        return replace(self, share=np.clip(share, nearest, 1.0 - nearest))

    def slopes(self, volume: LabelVolume) -> Floats:
        """By how many mm along its normal a vertex moves outward when `share` grows by 1, (V,); at least 0.3 of the edge."""
        mesh = self.mesh(volume)
        way = (self.ends[:, 1] - self.ends[:, 0]) @ volume.affine[:3, :3].T
        along = np.einsum("ij,ij->i", way, vertex_normals(mesh.vertices, mesh.faces, "area"))
        floor: Floats = np.maximum(along, 0.3 * np.linalg.norm(way, axis=1))
        return floor


def find_borders(volume: LabelVolume, numbers: NDArray[np.uint16], regions: Sequence[LabelledRegion]) -> tuple[Border, ...]:
    """The surfaces of all regions; two tissues that meet agree on their border. numbers: the grid with a tissue's per voxel."""
    nodes, faces = zip(*(_surface(region, numbers.shape, volume) for region in regions), strict=True)
    of_tissue = {name: _field(region, volume) for name, region in ((each.name, each) for each in regions)}
    crowd = _crowded(nodes, numbers.shape)
    borders = []
    for number, region in enumerate(regions):
        ends = nodes[number]
        inner, outer = (_at(of_tissue[region.name], region, ends[:, side], numbers.shape) for side in (0, 1))
        depth_inner, depth_outer = inner.copy(), -outer
        across = np.full(len(ends), -1, dtype=np.int64)
        for rival, other in enumerate(regions):
            if other is region:
                continue
            # where another tissue begins, both have a say; not where it encloses this one
            meets = _at(other.inside, other, ends[:, 1], numbers.shape) & ~_at(other.inside, other, ends[:, 0], numbers.shape)
            across[meets] = rival
            field = of_tissue[other.name]
            depth_inner[meets] = (inner[meets] - _at(field, other, ends[meets, 0], numbers.shape)) / 2
            depth_outer[meets] = (_at(field, other, ends[meets, 1], numbers.shape) - outer[meets]) / 2
        least = SMALLEST_DEPTH * volume.voxel_mm().min()
        depths = np.maximum(np.column_stack((depth_inner, depth_outer)), least).astype(np.float64)
        share = depths[:, 0] / depths.sum(axis=1)
        voxels = np.stack(np.unravel_index(ends, numbers.shape), axis=-1) - PAD
        size = float(region.inside.sum()) * volume.voxel_mm3()
        border = Border(region.name, voxels, faces[number], share, across, crowd[ends].any(axis=1), size)
        borders.append(border.with_share(share, NEAREST))
    return tuple(borders)


def _surface(region: LabelledRegion, shape: tuple[int, ...], volume: LabelVolume) -> tuple[Ints, Ints]:
    """Ends as flat numbers of the grid of all, faces outward in space."""
    ends, faces = surface_between(region.inside)
    places = np.stack(np.unravel_index(ends, region.inside.shape), axis=-1) + region.low
    flat: Ints = np.ravel_multi_index(tuple(np.moveaxis(places, -1, 0)), shape).astype(np.int64)
    left_handed = np.linalg.det(volume.affine[:3, :3]) < 0
    return flat, faces[:, ::-1] if left_handed else faces


def _field(region: LabelledRegion, volume: LabelVolume) -> NDArray[np.float32]:
    return signed_field(region.inside, volume.voxel_mm())


def _at(values: NDArray[Value], region: LabelledRegion, nodes: Ints, shape: tuple[int, ...]) -> NDArray[Value]:
    """Values of a region's box at nodes of the grid of all; the lowest value outside the box."""
    places = np.stack(np.unravel_index(nodes, shape), axis=-1) - region.low
    within = ((places >= 0) & (places < values.shape)).all(axis=1)
    found = np.full(len(nodes), values.min(), dtype=values.dtype)
    found[within] = values[tuple(places[within].T)]
    return found


def _crowded(nodes: Sequence[Ints], shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Nodes of the grid, flat, that have edges of two surfaces at them or at a neighbour."""
    count = np.zeros(int(np.prod(shape)), dtype=np.uint8)
    for ends in nodes:
        touched = np.unique(ends)
        count[touched] = np.minimum(count[touched] + 1, 2)
    return maximum_filter(count.reshape(shape), size=3).ravel() > 1


def balance(volume: LabelVolume, borders: Sequence[Border]) -> tuple[Border, ...]:
    """Shift every border by one length in all places, so that its tissue has the volume of its voxels; thin sheets come back.

    Where two tissues meet, one takes what the other gives.
    """
    balanced = list(borders)
    slopes = [border.slopes(volume) for border in borders]
    for _ in range(BALANCING_STEPS):
        meshes = [border.mesh(volume) for border in balanced]
        missing = np.array([border.volume_mm3 - _volume(mesh) for border, mesh in zip(balanced, meshes, strict=True)])
        if (np.abs(missing) < BALANCED * np.array([border.volume_mm3 for border in borders])).all():
            break
        areas = [face_areas(mesh.vertices, mesh.faces).sum() for mesh in meshes]
        shift = np.append(missing / np.array(areas), 0.0)  # -1, the air, takes and gives what it has to
        for number, border in enumerate(balanced):
            way = shift[number] - shift[border.across]
            balanced[number] = border.with_share(border.share + way / slopes[number], NEAREST)
    return tuple(balanced)


def _volume(mesh: Mesh) -> float:
    corners = mesh.triangles() - mesh.vertices.mean(axis=0)
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0)
