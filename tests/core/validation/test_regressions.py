"""What counts as worse than before: each promise has a mesh that breaks it."""

import numpy as np
import pytest

from core.mesh import Mesh
from core.validation.regressions import find_regressions
from core.validation.validate import validate
from tests.solids import cube, flipped, sphere, together, without_faces

SKIN, FAT = sphere(30.0, 2), sphere(29.0, 2)
THIN = {"skin": SKIN, "fat": FAT}
OPEN = {"mesh": without_faces(SKIN, [0])}
WORSE: dict[str, tuple[dict[str, Mesh], dict[str, Mesh], str]] = {
    "a hole": ({"mesh": SKIN}, OPEN, "no longer closed"),
    "turned inside out": ({"mesh": SKIN}, {"mesh": flipped(SKIN)}, "no longer oriented outward"),
    "a second piece": ({"mesh": SKIN}, {"mesh": together(SKIN, cube(1.0))}, "components 2, not 1"),
    "another genus": ({"mesh": OPEN["mesh"]}, {"mesh": without_faces(SKIN, [0, 100])}, "euler characteristic"),
    "too near": (THIN, {"skin": SKIN, "fat": sphere(29.99, 2)}, "0.00"),
    "crossing": (THIN, {"skin": SKIN, "fat": sphere(29.9, 3)}, "intersecting pairs"),
    "outside": (THIN, {"skin": SKIN, "fat": sphere(31.5, 2)}, "nest as"),
}


@pytest.mark.parametrize("case", WORSE)
def test_every_loss_is_named(case: str) -> None:
    before, after, words = WORSE[case]
    worse = find_regressions(validate(before, min_gap_mm=0.05), validate(after, min_gap_mm=0.05), 0.05)
    assert words in "; ".join(worse)


@pytest.mark.parametrize("surfaces", [THIN, OPEN, {"mesh": flipped(SKIN)}])
def test_what_stays_as_it_is_is_not_worse(surfaces: dict[str, Mesh]) -> None:
    found = validate(surfaces, min_gap_mm=0.05)
    assert find_regressions(found, found, 0.05) == []


def test_a_gap_that_was_too_small_before_may_stay() -> None:
    near = {"skin": SKIN, "fat": sphere(29.99, 2)}
    found = validate(near, min_gap_mm=0.05)
    assert find_regressions(found, found, 0.05) == []
    nearer = validate({"skin": SKIN, "fat": sphere(29.995, 2)}, min_gap_mm=0.05)
    assert "apart" in "; ".join(find_regressions(found, nearer, 0.05))


def test_order_of_the_surfaces_does_not_matter() -> None:
    turned = dict(reversed(THIN.items()))
    assert find_regressions(validate(THIN), validate(turned), 0.05) == []


def test_a_fold_of_a_fit_surface_is_named() -> None:
    vertices = SKIN.vertices.copy()
    vertices[np.argmax(vertices[:, 2])] *= -1.2  # through the other side
    folded = {"mesh": SKIN.with_vertices(vertices)}
    worse = "; ".join(find_regressions(validate({"mesh": SKIN}), validate(folded), 0.05))
    assert "self intersecting pairs where there were 0" in worse
