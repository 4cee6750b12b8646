"""A set that TetGen gives up on although it is sound: flat sides cut into triangles at random, and tilted."""

from __future__ import annotations

import numpy as np
import trimesh

from core.mesh import Mesh
from tests.solids import sphere


def tetgen_refuses() -> tuple[dict[str, Mesh], dict[str, str | None]]:
    """A sound set, and its nesting, that gmsh fills."""
    return {"box": flat_box_cut_anyhow(seed=9), "ball": sphere(10.0, 2)}, {"box": None, "ball": "box"}


def flat_box_cut_anyhow(seed: int) -> Mesh:
    """A tilted box whose flat sides are cut into triangles at random."""
    random = np.random.default_rng(seed)
    box = trimesh.creation.box((40.0, 40.0, 40.0)).subdivide().subdivide()
    vertices, faces = np.array(box.vertices), np.array(box.faces)
    for _ in range(300):
        first, corner = random.integers(len(faces)), random.integers(3)
        a, b, c = np.roll(faces[first], -corner)
        beside = (np.isin(faces, (a, b)).sum(axis=1) == 2) & (np.arange(len(faces)) != first)
        second = int(np.flatnonzero(beside)[0])
        d = next(each for each in faces[second] if each not in (a, b))
        at = vertices
        normal = np.cross(at[b] - at[a], at[c] - at[a])
        turns = [np.cross(at[d] - at[c], at[b] - at[c]) @ normal, np.cross(at[a] - at[c], at[d] - at[c]) @ normal]
        if min(turns) > 1e-9 and abs(normal @ (at[d] - at[a])) < 1e-9:  # convex and flat: the other diagonal does, too
            faces[first], faces[second] = (c, d, b), (d, c, a)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return Mesh.of(vertices @ (turn * np.linalg.det(turn)), faces).rounded_to_float32()
