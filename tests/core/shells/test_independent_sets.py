"""Sets without neighbours that hold every chosen vertex once."""

from __future__ import annotations

import numpy as np

from core.geometry.adjacency import edges
from core.geometry.connectivity import Connectivity
from core.shells.independent_sets import independent_sets
from tests.core.shells.solids import sphere


def test_sets_hold_every_chosen_vertex_once_and_no_two_neighbours():
    skin = sphere(20.0, 4)
    net = Connectivity.of(skin.faces, len(skin.vertices))
    chosen = np.random.default_rng(0).random(len(skin.vertices)) < 0.7
    sets = independent_sets(net, chosen)
    assert np.array_equal(np.sort(np.concatenate(sets)), np.flatnonzero(chosen))
    ends = edges(skin.faces).ends
    for members in sets:
        inside = np.zeros(len(skin.vertices), dtype=bool)
        inside[members] = True
        assert not inside[ends].all(axis=1).any()


def test_nothing_chosen_gives_no_sets():
    skin = sphere(20.0, 1)
    net = Connectivity.of(skin.faces, len(skin.vertices))
    assert independent_sets(net, np.zeros(len(skin.vertices), dtype=bool)) == []
