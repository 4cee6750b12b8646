"""TetGen fills the file as it is, and every tetrahedron gets the number of the tissue it lies in."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from core.package.region_tag import region_tags
from core.package.smesh import smesh_text
from tests.core.package.nested import tissues


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


@pytest.mark.parametrize("names", [("skin", "skin_2"), ("average_body", "muscle")])
def test_no_number_comes_twice(names):
    tags = region_tags([replace(tissues()[0], name=name) for name in names])
    assert len(set(tags.values())) == 2
