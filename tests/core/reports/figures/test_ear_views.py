"""Pictures of the ears: the region's colour where the box is, the canal's on its wall."""

import io

import numpy as np
from PIL import Image

from core.ears.find_ears import find_ears
from core.geometry.body_frame import find_body_frame
from core.reports.figures.ear_views import INSIDE, EarRegionView, draw_ears
from subjects.body import body

SKIN = body(0)
COLOURS = {"skin": (122, 76, 44)}


def draw(wall: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Pixels of the views, and the names of all figures."""
    frame = find_body_frame(SKIN)
    ears = [EarRegionView(ear.name, ear.low, ear.high, ear.low, ear.high, 707.0) for ear in find_ears(SKIN)]
    figures = draw_ears({"skin": SKIN}, COLOURS, frame, ears, wall)
    again = draw_ears({"skin": SKIN}, COLOURS, frame, ears, wall)
    assert [figure.png for figure in figures] == [figure.png for figure in again]
    return np.asarray(Image.open(io.BytesIO(figures[0].png)).convert("RGB")).astype(int), [figure.name for figure in figures]


def is_like(pixels: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """True where hue, not brightness, is nearer to the colour than to grey or skin."""
    red, _green, blue = (pixels[..., channel] for channel in range(3))
    return (red - blue > 60) if colour == INSIDE else (blue - red > 30)


def test_both_ears_are_in_the_middle_of_their_pictures():
    pixels, names = draw(np.zeros(len(SKIN.faces), dtype=bool))
    assert names == ["ears", "ears_sections"]
    yellow = is_like(pixels, INSIDE)
    for half in np.array_split(yellow, 2, axis=1):
        middle = half[half.shape[0] // 3 : 2 * half.shape[0] // 3, half.shape[1] // 3 : 2 * half.shape[1] // 3]
        assert middle.mean() > 0.6
        assert half[:, : half.shape[1] // 10].mean() < 0.01


def test_walls_of_canals_have_a_colour_of_their_own():
    ear = find_ears(SKIN)[0]
    wall = ear.holds(SKIN.triangles().mean(axis=1))
    none, some = (is_like(draw(faces)[0], (24, 128, 178)).mean() for faces in (np.zeros(len(wall), dtype=bool), wall))
    assert none == 0.0
    assert some > 0.05
