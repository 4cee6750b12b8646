"""Same drawing, same bytes, whatever the site's matplotlib settings are."""

import struct

import matplotlib
import pytest

from core.reports.figures.canvas import sheet, to_png


def draw(label: str = "depth [mm]") -> bytes:
    with sheet(2.0, 1.0) as figure:
        axes = figure.add_axes((0.2, 0.3, 0.7, 0.6))
        axes.plot([0, 1, 2], [3, 1, 2])
        axes.set_xlabel(label)
        return to_png(figure)


def chunks(png: bytes) -> list[bytes]:
    names, at = [], 8
    while at < len(png):
        (length,) = struct.unpack(">I", png[at : at + 4])
        names.append(png[at + 4 : at + 8])
        at += 12 + length
    return names


def test_settings_of_the_site_do_not_change_a_byte():
    plain = draw()
    with matplotlib.rc_context({"font.family": "serif", "axes.grid": True, "lines.linewidth": 9.0, "axes.facecolor": "red"}):
        assert draw() == plain


def test_the_settings_of_the_caller_come_back():
    with matplotlib.rc_context({"lines.linewidth": 7.5}):
        draw()
        assert matplotlib.rcParams["lines.linewidth"] == 7.5


def test_nothing_but_the_picture_is_in_the_file():
    assert set(chunks(draw())) == {b"IHDR", b"PLTE", b"IDAT", b"IEND"}


@pytest.mark.parametrize("name", ["$x^{", "$\\frac{1}{0}$", "a_b^c $5"])
def test_dollar_signs_are_letters(name):
    assert draw(name) != draw("")
