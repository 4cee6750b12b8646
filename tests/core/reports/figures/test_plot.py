"""Axes of our own: data lands on the pixel it belongs to, and nothing leaves its window."""

import io

import numpy as np
import pytest
from PIL import Image

from core.reports.figures.canvas import Sheet
from core.reports.figures.colour_bar import draw_colour_bar
from core.reports.figures.plot import Plot, round_values

BOX = (0.25, 0.25, 0.5, 0.5)  # of a sheet of 200 x 200 pixels: 50 to 150


def pixels(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=np.int64)


def red(picture: np.ndarray) -> np.ndarray:
    return (picture[:, :, 0] > 200) & (picture[:, :, 1] < 100)


def test_data_land_where_they_belong():
    sheet = Sheet(2.0, 2.0, 100)
    plot = Plot(sheet, BOX, (0.0, 10.0), (4.0, 30.0))
    plot.band(1.0, 2.0, "#ff0000", top=20.0)
    assert plot.at(2.0, 20.0) == (100.0, 100.0)
    found = red(pixels(sheet.png()))
    rows, columns = np.nonzero(found)
    assert (columns.min(), columns.max() + 1) == (75, 100)
    assert (200 - rows.max() - 1, 200 - rows.min()) == (50, 100)


def test_a_logarithmic_axis_gives_every_decade_the_same_room():
    sheet = Sheet(2.0, 2.0, 100)
    plot = Plot(sheet, BOX, (0.0, 1e-4), (1.0, 1.0), log_y=True)
    assert [plot.at(0.5, 10.0**power)[1] for power in (-4, -3, -2, -1, 0)] == pytest.approx([50, 75, 100, 125, 150])


def test_lines_end_at_the_window():
    sheet = Sheet(2.0, 2.0, 100)
    Plot(sheet, BOX, (0.0, 0.0), (1.0, 1.0)).line([-5.0, 5.0], [-5.0, 5.0], "#ff0000", 3.0)
    rows, columns = np.nonzero(red(pixels(sheet.png())))
    assert columns.min() >= 49
    assert columns.max() <= 150
    assert rows.min() >= 49
    assert rows.max() <= 150


def test_pictures_lie_below_the_drawing_and_may_leave_the_sheet():
    picture = np.zeros((50, 60, 4), dtype=np.uint8)
    sheet = Sheet(2.0, 2.0, 100)
    picture[:, :, 3] = 255
    sheet.place(picture, -20, 170)
    Plot(sheet, (0.0, 0.0, 1.0, 1.0), (0.0, 0.0), (1.0, 1.0)).line([0.0, 1.0], [0.95, 0.95], "#ff0000", 4.0)
    drawn = pixels(sheet.png())
    black = (drawn == 0).all(axis=2)
    assert black[:30, :40].sum() > 900
    assert not black[31:, :].any()
    assert not black[:, 41:].any()
    assert red(drawn)[:30, :40].any()


def test_a_colour_bar_runs_from_the_first_to_the_last_colour():
    sheet = Sheet(2.0, 2.0, 100)
    draw_colour_bar(sheet, BOX, "magma", 0.0, 2.0, "depth [mm]")
    row = pixels(sheet.png())[100, 55:145]
    assert row[0].sum() < 60
    assert row[-1].sum() > 600
    assert (np.diff(row.sum(axis=1)) >= -2).all()


@pytest.mark.parametrize(
    ("low", "high", "most", "expected"),
    [(0.0, 1.0, 6, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]), (-95.0, 95.0, 6, [-50.0, 0.0, 50.0]), (0.3, 0.31, 6, None)],
)
def test_round_values_lie_within_the_window(low, high, most, expected):
    values = round_values(low, high, most)
    assert all(low <= value <= high for value in values)
    assert 2 <= len(values) <= most + 1
    if expected is not None:
        assert values == pytest.approx(expected)


def test_whole_numbers_only_where_they_are_asked_for():
    assert round_values(0.0, 2.0, 8, whole=True) == [0.0, 1.0, 2.0]
