"""Same drawing, same bytes, whatever the site's matplotlib settings are; what is put on paper lies where and how it must."""

import io
import struct

import matplotlib
import numpy as np
import pytest
from matplotlib.path import Path
from PIL import Image

from core.reports.figures.canvas import Sheet, box_path, circle_path
from core.reports.figures.lettering import Letters

RED, BLUE = "#ff0000", "#0000ff"


def draw(label: str = "depth [mm]") -> bytes:
    sheet = Sheet(2.0, 1.0)
    wave = np.linspace(20.0, 280.0, 400)
    sheet.stroke(Path(np.column_stack([wave, 70.0 + 40.0 * np.sin(wave)])), BLUE, 1.2)
    sheet.stroke(circle_path(150.0, 70.0, 40.0), RED, 1.2, dashed=True)
    sheet.write(150.0, 10.0, label, across="center")
    return sheet.png()


def pixels(sheet: Sheet) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(sheet.png())).convert("RGB"), dtype=np.int64)


def ink(sheet: Sheet) -> tuple[int, int, int, int]:
    """Left, bottom, right and top of what is drawn, in pixels from the lower left corner."""
    drawn = pixels(sheet)
    rows, columns = np.nonzero(drawn.sum(axis=2) < 600)
    return int(columns.min()), len(drawn) - 1 - int(rows.max()), int(columns.max()) + 1, len(drawn) - int(rows.min())


def chunks(png: bytes) -> list[bytes]:
    names, at = [], 8
    while at < len(png):
        (length,) = struct.unpack(">I", png[at : at + 4])
        names.append(png[at + 4 : at + 8])
        at += 12 + length
    return names


def test_settings_of_the_site_do_not_change_a_byte():
    plain = draw()
    odd = {"font.family": "serif", "path.simplify": False, "path.snap": False, "lines.linewidth": 9.0, "savefig.dpi": 20}
    with matplotlib.rc_context(odd):
        assert draw() == plain


def test_nothing_but_the_picture_is_in_the_file():
    assert set(chunks(draw())) == {b"IHDR", b"PLTE", b"IDAT", b"IEND"}


@pytest.mark.parametrize("name", ["$x^{", "$\\frac{1}{0}$", "a_b^c $5"])
def test_dollar_signs_are_letters(name):
    assert draw(name) != draw("")


def test_areas_end_where_they_should_and_later_ones_cover_earlier_ones():
    sheet = Sheet(1.0, 1.0, 100)
    sheet.fill(box_path(10, 20, 60, 80), RED)
    sheet.fill(box_path(30, 20, 60, 80), BLUE)
    sheet.fill(box_path(30, 20, 60, 80), RED, level=0.0)
    assert ink(sheet) == (10, 20, 60, 80)
    drawn = pixels(sheet)
    assert drawn[50, 20].tolist() == [255, 0, 0]
    assert drawn[50, 45].tolist() == [0, 0, 255]


def test_a_dashed_circle_has_pauses_and_a_whole_one_none():
    def dark(dashed: bool) -> float:
        sheet = Sheet(1.0, 1.0, 100)
        sheet.stroke(circle_path(50, 50, 40), "#000000", 2.0, dashed=dashed)
        return float((pixels(sheet).sum(axis=2) < 300).sum())

    assert 0.5 * dark(False) < dark(True) < 0.85 * dark(False)


def test_dots_are_round_and_each_at_its_place():
    sheet = Sheet(2.0, 1.0, 72)
    sheet.dots([(20, 20), (100, 40)], 10.0, RED)
    assert ink(sheet) == pytest.approx((15, 15, 105, 45), abs=1)
    assert (pixels(sheet)[:, :, 1] < 128).sum() == pytest.approx(2 * np.pi * 25, rel=0.1)


@pytest.mark.parametrize("upwards", [False, True])
def test_words_lie_on_the_side_they_are_asked_for(upwards):
    def box(across: str, up: str) -> tuple[int, int, int, int]:
        sheet = Sheet(2.0, 2.0, 100)
        sheet.write(100, 100, "HHH", across=across, up=up, upwards=upwards)  # type: ignore[arg-type]
        return ink(sheet)

    left, right, middle = box("left", "center"), box("right", "center"), box("center", "center")
    assert left[0] >= 100 >= right[2]
    assert (middle[0] + middle[2]) / 2 == pytest.approx(100, abs=2)
    below, above = box("center", "top"), box("center", "bottom")
    assert below[3] <= 100 <= above[1]
    assert (middle[1] + middle[3]) / 2 == pytest.approx(100, abs=2)
    wide, high = middle[2] - middle[0], middle[3] - middle[1]
    assert (wide < high) is upwards


def test_the_waist_is_the_middle_of_what_stands_on_the_baseline():
    sheet = Sheet(1.0, 1.0, 100)
    sheet.write(50, 50, "8", across="center", up="waist", letters=Letters(20.0))
    _, bottom, _, top = ink(sheet)
    assert (bottom + top) / 2 == pytest.approx(50, abs=1.5)


def test_lines_of_words_lie_below_each_other():
    one, two = Sheet(1.0, 1.0, 100), Sheet(1.0, 1.0, 100)
    one.write(10, 90, "first", up="top")
    two.write(10, 90, "first\nsecond", up="top")
    assert ink(one)[3] == pytest.approx(ink(two)[3], abs=1)
    assert ink(one)[1] - ink(two)[1] == pytest.approx(8 * 100 / 72 * 1.2, abs=2)


def test_paper_shines_through_behind_words_on_a_ground():
    sheet = Sheet(1.0, 1.0, 100)
    sheet.fill(box_path(0, 0, 100, 100), BLUE)
    sheet.write(50, 50, "mm", across="center", up="center", ground=True)
    drawn = pixels(sheet)
    assert drawn[5, 5].tolist() == [0, 0, 255]
    assert (drawn[40:60, 35:65, 0] > 170).any()
