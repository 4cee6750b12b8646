"""gmsh itself opens the file; so does meshio."""

from __future__ import annotations

import meshio
import numpy as np
import pytest

from core.package.gmsh import write_surfaces
from core.package.merged_surfaces import merge
from core.package.region_tag import region_tags
from tests.core.package.nested import tissues
from tests.gmsh_reader import sizes_in_gmsh


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    target = tmp_path_factory.mktemp("gmsh") / "surfaces.msh"
    write_surfaces(target, merge(tissues()))
    return target


def test_gmsh_finds_one_surface_per_tissue(path):
    sizes = sizes_in_gmsh(path, dimension=2)
    assert sorted(sizes) == [1005, 1010, 1012]
    assert sizes == {1000 + tag: len(tissue.mesh.faces) for tissue, tag in _tagged()}


def test_the_header_is_that_of_simnibs(path):
    assert path.read_bytes().startswith(b"$MeshFormat\n2.2 1 8\n\x01\x00\x00\x00")


def test_vertices_come_back_bit_for_bit(path):
    read = meshio.read(path)
    merged = merge(tissues())
    np.testing.assert_array_equal(read.points, merged.vertices)
    np.testing.assert_array_equal(read.cells_dict["triangle"], merged.faces)
    np.testing.assert_array_equal(read.cell_data_dict["gmsh:physical"]["triangle"], merged.tags + 1000)


def _tagged():
    tags = region_tags(tissues())
    return [(tissue, tags[tissue.name]) for tissue in tissues()]
