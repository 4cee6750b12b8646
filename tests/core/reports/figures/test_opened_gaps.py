"""Sections before and after: where, in what order, and none if nothing moved."""

import numpy as np

from core.reports.figures.opened_gaps import draw_opened_gaps
from core.reports.palette import tissue_colours
from tests.solids import sphere

BEFORE = {"skin": sphere(30.0, 3), "organ": sphere(5.0, 3)}
COLOURS = tissue_colours(list(BEFORE))


def moved(name, vertex, way):
    vertices = BEFORE[name].vertices.copy()
    vertices[vertex] += way
    return BEFORE[name].with_vertices(vertices)


def test_the_farthest_move_comes_first_and_is_drawn():
    after = {"skin": moved("skin", 3, [0.0, 0.0, 0.1]), "organ": moved("organ", 5, [0.3, 0.0, 0.4])}
    figure = draw_opened_gaps(BEFORE, after, COLOURS)
    assert figure is not None
    assert figure.caption.index("organ by 0.5 mm") < figure.caption.index("skin by 0.1 mm")
    other = draw_opened_gaps(after, BEFORE, COLOURS)
    assert other is not None
    assert other.png != figure.png
    assert draw_opened_gaps(BEFORE, after, COLOURS) == figure


def test_nothing_is_drawn_where_nothing_moved():
    assert draw_opened_gaps(BEFORE, dict(BEFORE), COLOURS) is None


def test_moves_close_together_share_a_picture():
    way = np.zeros_like(BEFORE["organ"].vertices)
    way[:, 2] = 1.0  # the whole organ by 1 mm: its window of 30 mm holds all of it
    after = {"skin": BEFORE["skin"], "organ": BEFORE["organ"].with_vertices(BEFORE["organ"].vertices + way)}
    figure = draw_opened_gaps(BEFORE, after, COLOURS)
    assert figure is not None
    assert figure.caption.count("organ") == 1
