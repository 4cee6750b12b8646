"""The referee of the corpus must be able to say no."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from core.shells.nested_shells import Shell, create_shells
from core.validation.validate import validate
from subjects.generated.revolved import ball, torus
from subjects.generated.solid import comb
from subjects.trial import attempt, find_broken_promises, shells_inputs


def judge(skin: Mesh, *meshes: Mesh, min_gap_mm: float = 0.05) -> tuple[str, ...]:
    nothing = np.zeros(0)
    shells = tuple(Shell(f"layer_{row + 1}", mesh, nothing, nothing, nothing) for row, mesh in enumerate(meshes))
    surfaces = {"skin": skin, **{shell.name: shell.mesh for shell in shells}}
    return find_broken_promises(surfaces, shells, validate(surfaces, min_gap_mm=min_gap_mm), min_gap_mm)


def test_good_shells_pass() -> None:
    skin = ball(20, 3)
    assert judge(skin, *(shell.mesh for shell in create_shells(skin, shells_inputs((1.0, 3.0))))) == ()


def test_naive_offset_is_caught() -> None:
    skin = comb(3, 6, 0.4, 2.0)
    naive = skin.with_vertices(skin.vertices - 4.0 * vertex_normals(skin.vertices, skin.faces, "area")).rounded_to_float32()
    assert judge(skin, naive)


@pytest.mark.parametrize(
    ("meshes", "words"),
    [
        ((ball(17, 3), ball(19, 3)), "nesting"),
        ((ball(19.98, 3), ball(17, 3)), "gap"),
        ((Mesh.of(ball(19, 3).vertices * (1 + 1e-12), ball(19, 3).faces), ball(17, 3)), "single precision"),
        ((torus(10, 3), ball(1, 1)), "genus"),
    ],
)
def test_each_broken_promise_is_named(meshes: tuple[Mesh, ...], words: str) -> None:
    assert any(words in text for text in judge(ball(20, 3), *meshes))


def test_refusal_carries_places_and_facts() -> None:
    trial = attempt(torus(30, 2), (1.0, 3.0))
    assert (trial.outcome, trial.broken) == ("layer.deeper_than_reach", ())
    assert trial.places > 0
