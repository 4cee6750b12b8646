"""Any closed surface, any sensible request: proven shells or a named refusal."""

from __future__ import annotations

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from core.mesh import Mesh
from core.shells.nested_shells import create_shells
from subjects.deform import rough
from subjects.generated.revolved import ball, spiked, star_shape, tube
from subjects.generated.solid import block, comb, gear, needle
from subjects.trial import READY, attempt, shells_inputs

sizes = st.floats(4.0, 60.0)


@st.composite
def wavy_balls(draw: st.DrawFn) -> Mesh:
    """A radius made of waves in random directions; may be thin, may have deep valleys, never folds."""
    radius, height = draw(st.floats(5.0, 60.0)), draw(st.floats(0.0, 0.6))
    seed, waves = draw(st.integers(0, 2**16)), draw(st.integers(1, 6))
    directions = np.random.default_rng(seed).normal(size=(waves, 3)) * draw(st.floats(1.0, 6.0))

    def length(u: np.ndarray) -> np.ndarray:
        return radius * (1 + height * np.sin(u @ directions.T).mean(axis=1))

    return star_shape(length, 3)


@st.composite
def blocks(draw: st.DrawFn) -> Mesh:
    x, y, z = draw(sizes), draw(sizes), draw(st.floats(0.3, 30.0))
    return block(x, y, z, draw(st.floats(max(x, y, z) / 12, max(x, y, z))))


@st.composite
def rings(draw: st.DrawFn) -> Mesh:
    """A closed tube whose radius changes on the way."""
    t = 2 * np.pi * np.arange(48) / 48
    major, minor = draw(st.floats(20.0, 50.0)), draw(st.floats(1.0, 10.0))
    wave = 1 + draw(st.floats(0.0, 0.7)) * np.cos(draw(st.integers(1, 5)) * t)
    return tube(np.column_stack((major * np.cos(t), major * np.sin(t), np.zeros(48))), minor * wave, 12)


surfaces = st.one_of(
    wavy_balls(),
    blocks(),
    rings(),
    st.builds(rough, wavy_balls(), st.floats(0.0, 0.3), st.integers(0, 100)),
    st.builds(needle, sizes, st.floats(1.0, 10.0), st.integers(4, 16), st.floats(3.0, 10.0)),
    st.builds(comb, st.integers(2, 4), st.floats(4.0, 12.0), st.floats(0.05, 2.0), st.floats(3.0, 8.0)),
    st.builds(gear, sizes, st.integers(4, 10), st.floats(2.0, 10.0), st.floats(3.0, 10.0)),
    st.builds(spiked, sizes, st.integers(1, 6), st.floats(1.0, 30.0), st.floats(0.15, 0.5), st.just(3), st.integers(0, 100)),
)
depths = st.lists(st.floats(0.1, 6.0), min_size=1, max_size=4).map(
    lambda steps: tuple(float(depth) for depth in np.cumsum(np.round(steps, 3)))
)


@settings(max_examples=25)
@example(skin=needle(4.0, 1.0, 4, 3.0), depths_mm=(1.0,), min_gap_mm=0.01)
@given(skin=surfaces, depths_mm=depths, min_gap_mm=st.sampled_from([0.01, 0.05, 0.1]))
def test_proven_or_refused_with_places(skin: Mesh, depths_mm: tuple[float, ...], min_gap_mm: float) -> None:
    trial = attempt(skin, depths_mm, min_gap_mm)
    assert trial.broken == ()
    assert trial.outcome == READY or trial.outcome.partition(".")[0] in ("skin", "layer", "shells")


@settings(max_examples=8)
@given(radius_mm=st.floats(8.0, 80.0), share=st.floats(0.02, 0.6))
def test_ball_gives_a_ball(radius_mm: float, share: float) -> None:
    depth = max(0.1, share * radius_mm)
    (shell,) = create_shells(ball(radius_mm, 4), shells_inputs((depth,)))
    radii = np.linalg.norm(shell.mesh.vertices, axis=1)
    assert np.abs(radii - (radius_mm - depth)).max() <= 0.05 * depth + 0.003 * radius_mm  # the faceted ball's sagitta


@settings(max_examples=5)
@given(skin=surfaces, depths_mm=depths)
def test_equal_request_gives_equal_bytes(skin: Mesh, depths_mm: tuple[float, ...]) -> None:
    if attempt(skin, depths_mm).outcome != READY:
        return
    first, second = (create_shells(skin, shells_inputs(depths_mm)) for _ in range(2))
    for a, b in zip(first, second, strict=True):
        assert a.mesh.vertices.tobytes() == b.mesh.vertices.tobytes()
        assert a.mesh.faces.tobytes() == b.mesh.faces.tobytes()
