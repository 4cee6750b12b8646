"""Places of changes are circled by kind, and the course of smoothing is drawn with what was delivered."""

import io
from dataclasses import dataclass

import numpy as np
from PIL import Image

from core.reports.figures.change_places import MOST_PLACES, draw_change_places
from core.reports.figures.smoothing_course import draw_smoothing_course
from core.reports.palette import OTHER_COLOURS
from tests.solids import sphere

BALL = sphere(30.0, 3)
TOP = {"point_mm": (0.0, 0.0, 30.0), "distance_mm": 0.1}
SIDE = {"point_mm": (30.0, 0.0, 0.0), "distance_mm": 0.0}


def picture(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def has(image: np.ndarray, colour: tuple[int, int, int]) -> bool:
    return bool((np.abs(image - colour).max(axis=2) < 12).sum() > 20)


def test_each_kind_has_its_colour_and_each_mesh_its_picture() -> None:
    changes = [
        {"mesh": "skin", "kind": "holes", "count": 1, "places": [TOP]},
        {"mesh": "skin", "kind": "flipped_faces", "count": 250, "places": [SIDE] * 200},
        {"mesh": "skin", "kind": "extent", "message": "no places"},
        {"mesh": "fat", "what": "coordinates rounded to float32"},
    ]
    (figure,) = draw_change_places({"skin": BALL, "fat": sphere(20.0, 3)}, changes)
    assert figure.name == "changes_skin"
    assert "holes at 1 place; flipped faces at 250 places" in figure.caption
    image = picture(figure.png)
    assert has(image, OTHER_COLOURS[0])
    assert has(image, OTHER_COLOURS[1])
    assert not has(image, OTHER_COLOURS[2])
    assert len(changes[1]["places"]) > MOST_PLACES  # type: ignore[arg-type]


def test_nothing_changed_nothing_drawn() -> None:
    assert draw_change_places({"skin": BALL}, [{"mesh": "skin", "kind": "holes", "count": 0, "places": []}]) == ()


@dataclass(frozen=True)
class After:
    """A surface after an iteration."""

    lowest_quality: float
    mean_quality: float
    volume_mm3: float | None


def test_the_course_says_what_was_gained_and_at_which_iteration() -> None:
    closed = [After(4e-5, 0.5, 100.0), After(0.3, 0.6, 99.0), After(0.2, 0.7, 98.0)]
    opened = [After(0.0, 0.5, None), After(0.1, 0.6, None)]
    courses = {"skin": closed, "sheet": opened}
    figure = draw_smoothing_course(courses, {"skin": 1, "sheet": 1}, {"skin": (200, 0, 0), "sheet": (0, 0, 200)})
    assert "skin 4e-05 to 0.3 after 1 of 2 iterations made" in figure.caption
    image = picture(figure.png)
    right_half = image[:, image.shape[1] // 2 + 40 :]
    assert has(right_half, (200, 0, 0))
    assert not has(right_half[80:], (0, 0, 200))  # an open surface has no volume to draw
