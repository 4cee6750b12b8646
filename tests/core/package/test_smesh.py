"""TetGen fills the file as it is, and every tetrahedron gets the number of the tissue it lies in."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from core.geometry.containment import is_inside
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from core.package.region_tag import region_tags
from core.package.smesh import find_point_within, smesh_text
from core.package.tissue import FREE_SPACE, Tissue
from tests.core.package.nested import tissues
from tests.solids import sphere


def test_numbers_count_up_and_each_tissue_has_its_point():
    lines = smesh_text(tissues(), 1 / 3).splitlines()
    count = sum(len(tissue.mesh.vertices) for tissue in tissues())
    faces = sum(len(tissue.mesh.faces) for tissue in tissues())
    assert lines[1] == f"{count} 3 0 0"
    assert lines[count + 2] == f"{faces} 1"
    assert lines[count + faces + 3 : count + faces + 5] == ["0", "3"]
    regions = np.array([line.split() for line in lines[-3:]], dtype=float)
    assert regions[:, 4].tolist() == list(region_tags(tissues()).values())
    radius = np.linalg.norm(regions[:, 1:4] - (0.1, 0.2, 0.3), axis=1)
    assert ((radius < (10.0, 29 / 3, 9.0)) & (radius > (29 / 3, 9.0, 0.0))).all()


def test_marks_of_facets_are_those_of_their_tissue():
    rows = [line.split() for line in smesh_text(tissues(), 1 / 3).splitlines()]
    marks = Counter(int(row[4]) for row in rows if len(row) == 5 and row[0] == "3")
    assert marks == {tag: len(t.mesh.faces) for t, tag in zip(tissues(), region_tags(tissues()).values(), strict=True)}


def test_a_point_is_found_in_a_thin_shell_with_a_cavity():
    outer, inner = sphere(10.0, 2), sphere(9.97, 2)
    count = len(outer.vertices)
    mesh = Mesh.of(np.vstack([outer.vertices, inner.vertices]), np.vstack([outer.faces, inner.faces[:, ::-1] + count]))
    point = find_point_within(Tissue("skin", mesh, None, 0.465, FREE_SPACE), 0.04)
    assert point is not None
    assert is_inside(FaceTree.of(mesh.vertices, mesh.faces), point[None])[0]


def test_an_inside_out_surface_has_none():
    tissue = tissues()[0]
    inside_out = replace(tissue, mesh=Mesh.of(tissue.mesh.vertices, tissue.mesh.faces[:, ::-1]))
    assert find_point_within(inside_out, 0.04) is None


@pytest.mark.parametrize("names", [("skin", "skin_2"), ("average_body", "muscle")])
def test_no_number_comes_twice(names):
    tags = region_tags([replace(tissues()[0], name=name) for name in names])
    assert len(set(tags.values())) == 2
