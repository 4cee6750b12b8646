"""The robustness corpus: closed surfaces that shells must either be made for, provably, or be refused by name with places."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from core.mesh import Mesh
from subjects.body import body
from subjects.deform import bent, rough, scaled, twisted, waved
from subjects.fsaverage import brain, fsaverage
from subjects.generated import pieces, revolved, solid, voxels
from subjects.people import person
from subjects.trial import READY, Trial

THESIS = (1.0, 3.0)
FINE = (0.1, 0.2)
EAR = (0.3, 0.6)
ARMS_DOWN = (("upperarm01.L", (0.0, 0.0, -50.0)), ("upperarm01.R", (0.0, 0.0, 50.0)))
ARMS_UP = (("upperarm01.L", (0.0, 0.0, 35.0)), ("upperarm01.R", (0.0, 0.0, -35.0)))
SLIGHT_MAN = {"caucasian-male-young": 1.0, "universal-male-young-maxmuscle-minweight": 1.0}
STRIDE = (("upperleg01.L", (-30.0, 0.0, 0.0)), ("upperleg01.R", (25.0, 0.0, 0.0)))


@dataclass(frozen=True, slots=True)
class Subject:
    """expected: `ready`, or the code of the refusal; or_else: an outcome that is right as well.

    depths_mm: layers asked for. cost: `quick` ones run in `make test`, `normal` and `slow` ones with `pytest -m slow`.
    """

    name: str
    make: Callable[[], Mesh]
    expected: str = READY
    depths_mm: tuple[float, ...] = THESIS
    cost: str = "normal"
    or_else: str | None = None

    def is_right(self, trial: Trial) -> bool:
        """True if the trial ended as it must and nothing is held against it."""
        return trial.outcome in (self.expected, self.or_else) and not trial.broken


def head(subdivisions: int = 0) -> Mesh:
    """The base body above its collar bones, cut flat."""
    return solid.person_in(body(subdivisions), (-300, 540, -300), (300, 900, 300))


def hand(subdivisions: int = 0) -> Mesh:
    """The base body's left hand, cut off above the wrist."""
    return solid.person_in(body(subdivisions), (380, -200, -300), (700, 300, 300))


def foot(subdivisions: int = 0) -> Mesh:
    """The base body's left foot, cut off above the ankle."""
    return solid.person_in(body(subdivisions), (0, -900, -300), (300, -680, 300))


BODIES = (
    Subject("body", lambda: body(0)),
    Subject("body, loop-subdivided", lambda: body(1), cost="slow"),
    Subject("body, four layers", lambda: body(0), depths_mm=(0.3, 0.6, 1.0, 3.0)),
    Subject("body, heavy old man", lambda: person({"universal-male-old-maxmuscle-maxweight": 0.6})),
    Subject("body, heavy young woman", lambda: person({"universal-female-young-minmuscle-maxweight": 0.7})),
    Subject("body, slight young man", lambda: person(SLIGHT_MAN)),
    Subject("body, old man", lambda: person({"asian-male-old": 0.6})),
    Subject("body, muscular young man", lambda: person({"universal-male-young-maxmuscle-averageweight": 1.0})),
    Subject("body, baby by shape target", lambda: person({"caucasian-female-baby": 1.0}), "skin.self_intersecting", cost="quick"),
    Subject("body, a baby's size", lambda: scaled(body(0), 0.3, 0.3, 0.3)),
    Subject("body, arms up", lambda: person(turns=ARMS_UP)),
    Subject("body, arms down into the hips", lambda: person(turns=ARMS_DOWN), "skin.self_intersecting", cost="quick"),
    Subject("body, in stride", lambda: person(turns=STRIDE)),
    Subject("body, bowing", lambda: person(turns=(("spine03", (35.0, 0.0, 0.0)),))),
    Subject("body, looking down", lambda: person(turns=(("neck01", (40.0, 0.0, 0.0)),))),
    Subject("body, head turned", lambda: person(turns=(("neck01", (0.0, 40.0, 0.0)),))),
    Subject("body, twisted", lambda: twisted(body(0), 60.0)),
    Subject("body, bent over backwards", lambda: bent(body(0), 900.0)),
    Subject("body, rippled", lambda: waved(body(0), 6.0, 180.0)),
    Subject("body, scanner noise 0.1 mm", lambda: rough(body(0), 0.1)),
    Subject("body, inside out", lambda: pieces.inside_out(body(0)), "skin.inside_out", cost="quick"),
    Subject("body, with a hole", lambda: pieces.opened(body(0), 1), "skin.not_closed", cost="quick"),
    Subject("head of the body", head),
    Subject("hand of the body", hand),
    Subject("foot of the body", foot),
)
HEADS = (
    Subject("fsaverage head", lambda: fsaverage("head"), cost="quick"),
    Subject("fsaverage head, 10 mm deep", lambda: fsaverage("head"), depths_mm=(2.0, 5.0, 10.0)),
    Subject("fsaverage head, rough 0.3 mm", lambda: rough(fsaverage("head"), 0.3)),
    Subject("fsaverage inner skull", lambda: fsaverage("inner_skull-bem"), "skin.self_intersecting", cost="quick"),
    Subject("brain, left pial", lambda: brain("pial", "left")),
    Subject("brain, left white", lambda: brain("white", "left"), depths_mm=EAR),
    Subject("brain, right pial", lambda: brain("pial", "right"), "skin.self_intersecting", cost="quick"),
)
GENERATED = (
    Subject("cube of 12 faces", lambda: solid.block(60, 60, 60), cost="quick"),
    Subject("cube of 12 faces, 1 mm wide", lambda: solid.block(1, 1, 1), "layer.deeper_than_reach", cost="quick"),
    Subject("cube, fine", lambda: solid.block(40, 40, 40, 2.5), cost="quick"),
    Subject("plate thinner than the depth", lambda: solid.block(40, 40, 2, 2.0), "layer.deeper_than_reach", cost="quick"),
    Subject("plate that fits", lambda: solid.block(40, 40, 2, 1.0), depths_mm=EAR, cost="quick"),
    Subject("plate of 0.5 mm", lambda: solid.block(20, 20, 0.5, 1.0), depths_mm=FINE),
    Subject("wedge-like box", lambda: solid.block(60, 30, 8, 3.0), cost="quick"),
    Subject("needle", lambda: solid.needle(80, 6, 24, 2.0), cost="quick"),
    Subject("needle of long faces", lambda: solid.needle(80, 4, 12, None), depths_mm=EAR, cost="quick"),
    Subject("gear", lambda: solid.gear(25, 12, 12, 1.5)),
    Subject("comb with slits of 0.2 mm", lambda: solid.comb(5, 10, 0.2, 2.0), cost="quick"),
    Subject("fingers 0.2 mm apart", lambda: solid.near_touching_fingers(7, 0.2, 1.5)),
    Subject("fingers 0.02 mm apart", lambda: solid.near_touching_fingers(7, 0.02, 1.5)),
    Subject("bowl with a wall of 3 mm", lambda: solid.bowl(30, 3, 64), depths_mm=EAR),
    Subject("ball with an internal cavity", lambda: solid.hollow_ball(30, 10, 48), "skin.several_bodies", cost="quick"),
    Subject("block with crossing holes", lambda: solid.drilled_block(50, 8, 2.0)),
    Subject("ball", lambda: revolved.ball(30, 4), cost="quick"),
    Subject("ball, six layers", lambda: revolved.ball(30, 4), depths_mm=(0.3, 0.6, 1.0, 2.0, 3.0, 5.0), cost="quick"),
    Subject("ball far from the origin", lambda: pieces.moved(revolved.ball(30, 4), 3000, -2000, 1000), cost="quick"),
    Subject("ball of 328k faces", lambda: revolved.ball(600, 7), cost="slow"),
    Subject("ball of 1.3 M faces", lambda: revolved.ball(900, 8), cost="slow"),
    Subject("cauliflower", lambda: revolved.bumpy(40, 5, 9, 5)),
    Subject("ball with spikes", lambda: revolved.spiked(30, 25, 25, 0.12, 5)),
    Subject("scanned noise on a ball", lambda: rough(revolved.ball(50, 5), 0.15)),
    Subject("scanned noise that folds", lambda: rough(revolved.ball(50, 5), 2.0), "skin.self_intersecting", cost="quick"),
    Subject("torus", lambda: revolved.torus(30, 8), cost="quick"),
    Subject("torus thinner than the depth", lambda: revolved.torus(30, 2), "layer.deeper_than_reach", cost="quick"),
    Subject(
        "torus links",
        lambda: pieces.together(revolved.torus(30, 8), pieces.moved(pieces.turned_upright(revolved.torus(30, 8)), 30, 0, 0)),
        "skin.several_bodies",
        cost="quick",
    ),
    Subject(
        "two pieces",
        lambda: pieces.together(revolved.ball(20, 3), pieces.moved(revolved.ball(20, 3), 60, 0, 0)),
        "skin.several_bodies",
        cost="quick",
    ),
    Subject("trefoil knot", lambda: revolved.knot(12, 6, 300, 32), cost="quick"),
    Subject("ring from thick to thin", lambda: revolved.pinched_ring(40, 8, 1.5), cost="quick"),
    Subject("staircase ball", lambda: voxels.staircase_ball(30, 2.0), cost="quick"),
    Subject("staircase egg", lambda: voxels.staircase_ellipsoid(45, 30, 20, 1.5)),
    Subject("gyroid sponge, level on grid points", lambda: voxels.gyroid_ball(30, 24, 1.0), "skin.degenerate", cost="quick"),
    Subject("gyroid sponge", lambda: voxels.gyroid_ball(30, 25.3, 1.13), depths_mm=EAR, or_else="shells.no_room"),
    Subject("merged droplets", lambda: voxels.blobs(6, 60, 2.0)),  # faces down to q = 1e-5
)
CORPUS = (*BODIES, *HEADS, *GENERATED)
