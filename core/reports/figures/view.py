"""Look at a mesh: an orthographic camera and a z-buffer, a picture of 100k faces in a tenth of a second."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from core.geometry.normals import vertex_normals
from core.mesh import Mesh

Floats = NDArray[np.float64]
Depths = NDArray[np.float32]
NOTHING = np.float32(-np.inf)  # depth of a sample where nothing is
LOWEST_BIT = np.uint8(1)  # set in every channel: the eye sees no difference, and the PNG takes a fifth less
SAMPLES = 2  # pixels are drawn 2 x 2 and averaged
AMBIENT = 0.45
OUTLINE_JUMP_MM = 8.0  # a step in depth that gets a line: an arm in front of the chest, an ear before the head
OUTLINE_SHADE = 0.55
WIDE_FACE = 16  # samples; of a wider face it pays to work out where each row begins and ends
SPAN_RIM = 3  # samples at both ends of such a row may lie outside of the face
MOST_SAMPLES_TRIED = 200_000_000  # a body tries some 10 million; thousands of sheets across the window get thinned


@dataclass(frozen=True, slots=True)
class View:
    """Where right, up and towards the viewer are, and the window in mm along right and up.

    low, high: (2,) mm, corners of the window. pixels_per_mm: of the finished picture.
    """

    right: Floats
    up: Floats
    low: Floats
    high: Floats
    pixels_per_mm: float

    @classmethod
    def of(cls, right: ArrayLike, up: ArrayLike, low: ArrayLike, high: ArrayLike, pixels_high: int) -> View:
        """A view `pixels_high` tall; vectors (3,), window corners (2,) mm."""
        lowest, highest = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
        scale = pixels_high / float(highest[1] - lowest[1])
        return cls(np.asarray(right, dtype=np.float64), np.asarray(up, dtype=np.float64), lowest, highest, scale)

    @property
    def toward(self) -> Floats:
        """Unit vector towards the viewer."""
        (ax, ay, az), (bx, by, bz) = self.right.tolist(), self.up.tolist()
        return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])

    def flatten(self, points: Floats) -> Floats:
        """Coordinates (N, 2) mm along right and up."""
        flat: Floats = np.column_stack([points @ self.right, points @ self.up])
        return flat

    def to_samples(self, points: Floats) -> Floats:
        """Column and row (N, 2) of points on the fine grid of the z-buffer; row 0 at the top."""
        scale = self.pixels_per_mm * SAMPLES
        flat = self.flatten(points)
        pixels: Floats = np.column_stack([(flat[:, 0] - self.low[0]) * scale, (self.high[1] - flat[:, 1]) * scale])
        return pixels


@dataclass(frozen=True, slots=True)
class Surface:
    """A mesh with what every view of it needs; normals (V, 3)."""

    mesh: Mesh
    normals: Floats

    @classmethod
    def of(cls, mesh: Mesh) -> Surface:
        """Work out the normals once for all views."""
        return cls(mesh, vertex_normals(mesh.vertices, mesh.faces, "area"))


@dataclass(frozen=True, slots=True)
class Raster:
    """What a view sees of a surface, row 0 at the top, SAMPLES times as fine as the picture.

    projected: (V, 3) column, row and depth of the vertices, from the nearest one on. depth: (H, W) mm from that towards the
    viewer, NOTHING where nothing is. face: (H, W) int32, of samples where there is something.
    """

    view: View
    surface: Surface
    projected: Floats
    nearest_mm: float
    face: NDArray[np.int32]
    depth: Depths

    def covered(self) -> NDArray[np.bool_]:
        """True for samples that show a face, (H, W)."""
        return self.depth > NOTHING

    def paint(self, face_colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Opaque picture (H/SAMPLES, W/SAMPLES, 4) of faces in colours (F, 3), on white; lit from above the viewer's left
        shoulder, both sides of a face alike, with a line where the depth jumps."""
        lamp = 0.9 * self.view.toward + 0.35 * self.view.up - 0.25 * self.view.right
        facing = np.abs(self.surface.normals @ (lamp / np.linalg.norm(lamp)))
        brightness = AMBIENT + (1.0 - AMBIENT) * facing
        light = _light_of_faces(self.projected, self.surface.mesh.faces, brightness)
        jump_mm = max(OUTLINE_JUMP_MM, 3.0 / self.view.pixels_per_mm)
        picture = np.empty((self.face.shape[0] // SAMPLES, self.face.shape[1] // SAMPLES, 4), dtype=np.uint8)
        _paint(light, self.face, self.depth, jump_mm, face_colours, picture)
        return picture

    def sees(self, points: Floats, slack_mm: float) -> NDArray[np.bool_]:
        """True for points (N, 3) inside the window with nothing more than slack_mm in front of them, (N,)."""
        columns, rows = np.floor(self.view.to_samples(points)).astype(np.int64).T
        height, width = self.face.shape
        inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
        depth = self.depth[rows[inside], columns[inside]] + self.nearest_mm
        visible = np.zeros(len(points), dtype=np.bool_)
        visible[inside] = (points[inside] @ self.view.toward) >= depth - slack_mm
        return visible


class Scratch:
    """Room for the samples of one view after another: fresh memory costs more time than drawing into it."""

    def __init__(self) -> None:
        self._face = np.empty(0, dtype=np.int32)
        self._depth = np.empty(0, dtype=np.float32)

    def of(self, height: int, width: int) -> tuple[NDArray[np.int32], Depths]:
        """Room for faces, and depths of nothing, (height, width); what was given before is overwritten."""
        count = height * width
        if len(self._face) < count:
            self._face, self._depth = np.empty(count, dtype=np.int32), np.empty(count, dtype=np.float32)
        face, depth = self._face[:count].reshape(height, width), self._depth[:count].reshape(height, width)
        depth.fill(NOTHING)
        return face, depth


def look(surface: Surface, view: View, scratch: Scratch | None = None) -> Raster:
    """What the view sees of the surface; with scratch the answer holds until the next look with it."""
    width, height = (max(1, round(float(size) * view.pixels_per_mm)) * SAMPLES for size in view.high - view.low)
    vertices, faces = surface.mesh.vertices, surface.mesh.faces
    towards = vertices @ view.toward
    nearest_mm = float(towards.max(initial=-np.inf)) if len(towards) else 0.0
    projected = np.column_stack([view.to_samples(vertices), towards - nearest_mm])
    face, depth = (scratch or Scratch()).of(height, width)
    _draw_faces(projected, faces, _stride(projected, faces, face.shape), face, depth)
    return Raster(view, surface, projected, nearest_mm, face, depth)


def _stride(projected: Floats, faces: NDArray[np.int32], shape: tuple[int, ...]) -> int:
    """1, or every how manieth face to draw so that a soup of huge faces takes bounded time."""
    return 1 + int(_count_tried(projected, faces, shape[0], shape[1]) / MOST_SAMPLES_TRIED)


@njit(cache=True, nogil=True)
def _count_tried(projected: Floats, faces: NDArray[np.int32], height: int, width: int) -> float:
    """Samples in the boxes around all faces, within a grid of height x width."""
    total = 0.0
    for f in range(len(faces)):
        size = 1.0
        for axis, limit in ((0, width), (1, height)):
            first = projected[faces[f, 0], axis]
            second, third = projected[faces[f, 1], axis], projected[faces[f, 2], axis]
            low, high = max(0.0, min(first, second, third)), min(float(limit), max(first, second, third))
            size *= max(0.0, high - low) + 1.0
        total += size
    return total


@njit(cache=True, nogil=True)
def _draw_faces(
    projected: Floats, faces: NDArray[np.int32], stride: int, face_of_sample: NDArray[np.int32], depth_of_sample: Depths
) -> None:
    """Write the nearest face and its depth to every sample it covers; of several as near the first drawn stays.

    First all faces that are seen from in front, then those from behind: of a closed surface these are hidden already.
    projected (V, 3): column, row, depth. faces (F, 3), every stride-th is drawn. face_of_sample (H, W): out,
    depth_of_sample (H, W): in and out."""
    height, width = face_of_sample.shape
    for behind in (False, True):
        for f in range(0, len(faces), stride):
            a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
            ax, ay, az = projected[a, 0], projected[a, 1], projected[a, 2]
            bx, by, bz = projected[b, 0] - ax, projected[b, 1] - ay, projected[b, 2] - az
            cx, cy, cz = projected[c, 0] - ax, projected[c, 1] - ay, projected[c, 2] - az
            doubled = bx * cy - cx * by  # rows run downwards, so of a face seen from in front this is negative
            if doubled == 0.0 or (doubled > 0.0) != behind:
                continue
            left = max(0, int(np.ceil(ax + min(0.0, bx, cx) - 0.5)))
            right = min(width - 1, int(np.floor(ax + max(0.0, bx, cx) - 0.5)))
            top = max(0, int(np.ceil(ay + min(0.0, by, cy) - 0.5)))
            bottom = min(height - 1, int(np.floor(ay + max(0.0, by, cy) - 0.5)))
            if left > right or top > bottom:
                continue
            nearest = np.float32(az + max(0.0, bz, cz))
            share = 1.0 / doubled
            step_b, step_c = cy * share, -by * share  # of the weights of the corners from column to column
            for row in range(top, bottom + 1):
                hidden = behind
                if behind:
                    for column in range(left, right + 1):
                        hidden &= depth_of_sample[row, column] >= nearest
                if hidden:
                    continue
                y = row + 0.5 - ay
                row_b, row_c = -cx * y * share, bx * y * share
                row_depth, step_depth = az + row_b * bz + row_c * cz, step_b * bz + step_c * cz
                first, last, rim = left, right, right - left + 1
                if right - left >= WIDE_FACE:
                    first, last = _span(left, right, row_b, step_b, row_c, step_c, ax)
                    rim = SPAN_RIM
                entered = False
                for column in range(first, last + 1):
                    x = column + 0.5 - ax
                    if column - first < rim or last - column < rim:
                        weight_b, weight_c = row_b + x * step_b, row_c + x * step_c
                        if weight_b < 0.0 or weight_c < 0.0 or weight_b + weight_c > 1.0:
                            if entered:
                                break
                            continue
                    entered = True
                    depth = np.float32(row_depth + x * step_depth)
                    if depth > depth_of_sample[row, column]:
                        depth_of_sample[row, column] = depth
                        face_of_sample[row, column] = f


@njit(cache=True, nogil=True)
def _span(left: int, right: int, row_b: float, step_b: float, row_c: float, step_c: float, ax: float) -> tuple[int, int]:
    """The columns of a row between which all weights may be positive, with one to spare on each side."""
    low, high = left + 0.5 - ax, right + 0.5 - ax
    for at, step in ((row_b, step_b), (row_c, step_c), (1.0 - row_b - row_c, -step_b - step_c)):
        if step > 0.0:
            low = max(low, -at / step)
        elif step < 0.0:
            high = min(high, -at / step)
    if not low <= high + 2.0:
        return left, left - 1
    return max(left, int(np.floor(low + ax - 1.5))), min(right, int(np.ceil(high + ax + 0.5)))


@njit(cache=True, nogil=True)
def _light_of_faces(projected: Floats, faces: NDArray[np.int32], brightness: Floats) -> Floats:
    """What gives the light of a face (F, 3) at column x and row y: the first number, plus the others times x and y.

    projected (V, 3): column, row, depth. brightness (V,)."""
    light = np.zeros((len(faces), 3))
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        bx, by = projected[b, 0] - projected[a, 0], projected[b, 1] - projected[a, 1]
        cx, cy = projected[c, 0] - projected[a, 0], projected[c, 1] - projected[a, 1]
        doubled = bx * cy - cx * by
        if doubled == 0.0:
            continue
        more_b, more_c = (brightness[b] - brightness[a]) / doubled, (brightness[c] - brightness[a]) / doubled
        light[f, 1], light[f, 2] = more_b * cy - more_c * by, more_c * bx - more_b * cx
        light[f, 0] = brightness[a] - light[f, 1] * projected[a, 0] - light[f, 2] * projected[a, 1]
    return light


@njit(cache=True, nogil=True, inline="always")
def _is_outline(depth: Depths, row: int, column: int, jump_mm: float) -> bool:
    """True on the near side of a step in depth (H, W) between neighbouring samples."""
    height, width = depth.shape
    limit = depth[row, column] - jump_mm
    return bool(
        (row > 0 and depth[row - 1, column] < limit)
        or (row < height - 1 and depth[row + 1, column] < limit)
        or (column > 0 and depth[row, column - 1] < limit)
        or (column < width - 1 and depth[row, column + 1] < limit)
    )


@njit(cache=True, nogil=True, inline="always")
def _is_calm(depth: Depths, row: int, column: int, jump_mm: float) -> bool:
    """True if no sample of the pixel that begins there can be on an outline: nothing around is much deeper."""
    height, width = depth.shape
    if row == 0 or column == 0 or row + SAMPLES >= height or column + SAMPLES >= width:
        return False
    nearest = farthest = depth[row, column]
    for y in range(row - 1, row + SAMPLES + 1):
        for x in range(column - 1, column + SAMPLES + 1):
            nearest, farthest = max(nearest, depth[y, x]), min(farthest, depth[y, x])
    return bool(farthest >= nearest - jump_mm)


@njit(cache=True, nogil=True, inline="always")
def _is_one_face(face: NDArray[np.int32], row: int, column: int) -> bool:
    """True if all samples of the pixel that begins there show the same face."""
    others = 0
    for y in range(row, row + SAMPLES):
        for x in range(column, column + SAMPLES):
            others += face[y, x] != face[row, column]
    return others == 0


@njit(cache=True, nogil=True)
def _paint(
    light_of_faces: Floats,
    face_of_sample: NDArray[np.int32],
    depth: Depths,
    jump_mm: float,
    face_colours: NDArray[np.uint8],
    picture: NDArray[np.uint8],
) -> None:
    """Light, outline and average the samples into picture (H, W, 4); light_of_faces as `_light_of_faces` gives it."""
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            picture[y, x, 3] = 255
            first_row, first_column = y * SAMPLES, x * SAMPLES
            shown = 0
            for sample in range(SAMPLES * SAMPLES):
                shown += depth[first_row + sample // SAMPLES, first_column + sample % SAMPLES] > NOTHING
            if not shown:
                picture[y, x, 0] = picture[y, x, 1] = picture[y, x, 2] = 255
                continue
            calm = _is_calm(depth, first_row, first_column, jump_mm)
            if calm and _is_one_face(face_of_sample, first_row, first_column):
                f, row, column = face_of_sample[first_row, first_column], first_row + 0.5 * SAMPLES, first_column + 0.5 * SAMPLES
                # light changes evenly along a face: its mean over the samples is that in the middle of the pixel
                light = light_of_faces[f, 0] + light_of_faces[f, 1] * column + light_of_faces[f, 2] * row
                for channel in range(3):
                    picture[y, x, channel] = np.uint8(face_colours[f, channel] * light + 0.5) | LOWEST_BIT
                continue
            red = green = blue = 0.0
            for sample in range(SAMPLES * SAMPLES):
                row, column = first_row + sample // SAMPLES, first_column + sample % SAMPLES
                if depth[row, column] == NOTHING:
                    red, green, blue = red + 255.0, green + 255.0, blue + 255.0
                    continue
                f = face_of_sample[row, column]
                light = light_of_faces[f, 0] + light_of_faces[f, 1] * (column + 0.5) + light_of_faces[f, 2] * (row + 0.5)
                if not calm and _is_outline(depth, row, column, jump_mm):
                    light *= OUTLINE_SHADE
                red += face_colours[f, 0] * light
                green += face_colours[f, 1] * light
                blue += face_colours[f, 2] * light
            total = SAMPLES * SAMPLES
            picture[y, x, 0] = np.uint8(red / total + 0.5) | LOWEST_BIT
            picture[y, x, 1] = np.uint8(green / total + 0.5) | LOWEST_BIT
            picture[y, x, 2] = np.uint8(blue / total + 0.5) | LOWEST_BIT
