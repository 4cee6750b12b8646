"""GLB: fit for the validator of those who wrote the format, and read back by another library."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh

from core.io.registry import write_mesh
from core.mesh import Mesh
from core.package.glb import VEIL, surfaces_glb
from tests.core.io.tiny import TETRAHEDRON
from tests.core.package.nested import tissues
from tests.gltf_validator import find_gltf_issues


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    path = tmp_path_factory.mktemp("glb") / "surfaces.glb"
    path.write_bytes(surfaces_glb(tissues()))
    return path


def test_the_validator_of_the_format_finds_nothing(packed: Path) -> None:
    assert find_gltf_issues(packed) == []


def test_normals_are_units_even_where_a_surface_has_none(tmp_path: Path) -> None:
    flat = Mesh.of(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 5, 5)]), np.array([(0, 1, 2), (0, 2, 1)]))
    write_mesh(flat, tmp_path / "flat.glb", "glb", "flat")
    assert "ACCESSOR_VECTOR3_NON_UNIT" not in find_gltf_issues(tmp_path / "flat.glb")


def test_the_validator_would_tell(packed: Path, tmp_path: Path) -> None:
    data = packed.read_bytes()
    (tmp_path / "wrong.glb").write_bytes(data.replace(b'"componentType":5126', b'"componentType":5123', 1))
    assert find_gltf_issues(tmp_path / "wrong.glb")
    (tmp_path / "cut.glb").write_bytes(data[:-100])
    assert "GLB_UNEXPECTED_END_OF_CHUNK_DATA" in find_gltf_issues(tmp_path / "cut.glb")


def test_trimesh_reads_tissues_by_name_in_metres_and_in_their_colours(packed: Path) -> None:
    scene = trimesh.load(packed)
    assert set(scene.graph.nodes_geometry) == {"skin", "fat", "average_body"}
    np.testing.assert_allclose(scene.extents, np.ptp(tissues()[0].mesh.vertices, axis=0) / 1000.0, rtol=1e-6)
    for tissue in tissues():
        read = scene.geometry[tissue.name]
        np.testing.assert_array_equal(read.vertices, tissue.mesh.vertices)
        np.testing.assert_array_equal(read.faces, tissue.mesh.faces)
        alpha = read.visual.material.baseColorFactor[3] / 255
        assert alpha == pytest.approx(1.0 if tissue.name == "average_body" else VEIL, abs=0.01)


def test_the_same_mesh_gives_the_same_bytes(packed: Path) -> None:
    assert surfaces_glb(tissues()) == packed.read_bytes()


def test_vtu_holds_every_coordinate(tmp_path: Path) -> None:
    write_mesh(TETRAHEDRON, tmp_path / "part.vtu", "vtu", "part")
    read = meshio.read(tmp_path / "part.vtu")
    np.testing.assert_array_equal(read.points, TETRAHEDRON.vertices)
    np.testing.assert_array_equal(read.cells_dict["triangle"], TETRAHEDRON.faces)
