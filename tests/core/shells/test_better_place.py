"""A vertex goes where its worst face is best, and stays on the surface."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.connectivity import Connectivity
from core.geometry.quality import quality
from core.shells.better_place import better_places
from tests.core.shells.solids import cube, sphere


def around(net: Connectivity, vertex: int) -> np.ndarray:
    return np.flatnonzero((net.faces == vertex).any(axis=1))


def test_vertex_pushed_aside_on_a_flat_side_comes_back_without_leaving_it():
    skin = cube(60.0, cuts=3)
    net = Connectivity.of(skin.faces, len(skin.vertices))
    vertex = int(np.flatnonzero((np.abs(skin.vertices) < 29).sum(axis=1) == 2)[0])
    side = int(np.argmax(np.abs(skin.vertices[vertex])))
    vertices = skin.vertices.copy()
    vertices[vertex, (side + 1) % 3] += 5.5
    before = quality(vertices, net.faces)[around(net, vertex)].min()
    (place,) = better_places(vertices, net, np.array([vertex]))
    assert place[side] == pytest.approx(vertices[vertex, side], abs=1e-12)
    vertices[vertex] = place
    assert quality(vertices, net.faces)[around(net, vertex)].min() > max(0.5, 1.5 * before)


def test_no_place_is_worse_than_the_one_a_vertex_has():
    skin = sphere(20.0, 3)
    net = Connectivity.of(skin.faces, len(skin.vertices))
    rng = np.random.default_rng(0)
    vertices = skin.vertices + rng.normal(scale=0.4, size=skin.vertices.shape)
    chosen = np.arange(0, len(vertices), 7)
    for vertex, place in zip(chosen, better_places(vertices, net, chosen), strict=True):
        alone = vertices.copy()
        alone[vertex] = place
        faces = net.faces[around(net, vertex)]
        assert quality(alone, faces).min() >= quality(vertices, faces).min() - 1e-12
