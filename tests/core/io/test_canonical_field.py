from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.errors import InternalError
from core.field_source import FieldData, FieldMesh, FieldTable
from core.io import canonical
from core.io.canonical_field import load_field, save_field
from tests.core.io.tiny import TETRAHEDRON


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "field"


def test_a_table_comes_back(file: Path) -> None:
    table = FieldTable(("x", "", "Ex"), np.array([[1.0, 2], [np.nan, 4], [5, np.inf]]), 25.4)
    save_field(table, file)
    found = load_field(file)
    assert isinstance(found, FieldTable)
    assert (found.names, found.mm_per_unit) == (table.names, 25.4)
    np.testing.assert_array_equal(found.columns, table.columns)


def test_a_mesh_comes_back(file: Path) -> None:
    data = (FieldData("E", "elements", np.ones((2, 3))), FieldData("v", "nodes", np.arange(5.0)[:, None]))
    corners = np.array([[0, 1, 2]], np.int32), np.array([[0, 1, 2, 3]], np.int32)
    mesh = FieldMesh(np.arange(15.0).reshape(5, 3), *corners, data)
    save_field(mesh, file)
    found = load_field(file)
    assert isinstance(found, FieldMesh)
    np.testing.assert_array_equal(found.nodes, mesh.nodes)
    np.testing.assert_array_equal(found.tetrahedra, mesh.tetrahedra)
    assert [(each.name, each.where) for each in found.data] == [("E", "elements"), ("v", "nodes")]
    np.testing.assert_array_equal(found.data[1].values, data[1].values)


def test_a_mesh_of_a_surface_is_no_field(file: Path) -> None:
    canonical.save(TETRAHEDRON, file)
    with pytest.raises(InternalError) as caught:
        load_field(file)
    assert caught.value.code == "canonical.corrupt"
