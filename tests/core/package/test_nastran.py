"""The bulk data, read by meshio, is the surfaces; small and negative numbers keep their digits."""

from __future__ import annotations

import meshio
import numpy as np

from core.mesh import Mesh
from core.package.merged_surfaces import merge
from core.package.nastran import bulk_data
from core.package.tissue import FREE_SPACE, Tissue
from tests.core.package.nested import tissues
from tests.solids import sphere


def read(text, tmp_path):
    path = tmp_path / "surfaces.nas"
    path.write_text(text)
    return meshio.read(path)


def test_meshio_reads_surfaces_and_properties_back(tmp_path):
    merged = merge(tissues())
    mesh = read(bulk_data(merged), tmp_path)
    np.testing.assert_array_equal(mesh.points.astype(np.float32), merged.vertices.astype(np.float32))
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], merged.faces)
    np.testing.assert_array_equal(mesh.cell_data_dict["nastran:ref"]["triangle"], merged.tags)


def test_small_negative_numbers_fit_their_field(tmp_path):
    ball = sphere(1.0, 1)
    tiny = Mesh.of(ball.vertices * -1.2345678e-12, ball.faces[:, ::-1]).rounded_to_float32()
    text = bulk_data(merge([Tissue("skin", tiny, None, 0.465, FREE_SPACE)]))
    assert max(len(line) for line in text.splitlines()) <= 8 + 4 * 16
    mesh = read(text, tmp_path)
    np.testing.assert_array_equal(mesh.points.astype(np.float32), tiny.vertices.astype(np.float32))
