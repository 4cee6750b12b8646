from __future__ import annotations

import struct
from pathlib import Path

import meshio
import numpy as np
import pytest

from core.errors import InputError
from core.field_source import FieldMesh
from core.io.msh import read_msh
from tests.gmsh_reader import rewrite_by_gmsh

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
TRIANGLES = np.array([[0, 1, 2], [1, 2, 4]])
TETRAHEDRA = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
VECTORS = [np.arange(6.0).reshape(2, 3), 10 + np.arange(6.0).reshape(2, 3)]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "field.msh"


def write(path: Path) -> None:
    """gmsh 2.2, binary."""
    tags = [np.array([1001, 1001]), np.array([1, 2])]
    mesh = meshio.Mesh(
        POINTS,
        [("triangle", TRIANGLES), ("tetra", TETRAHEDRA)],
        point_data={"v": np.arange(5.0), "A": np.arange(15.0).reshape(5, 3)},
        cell_data={
            "E": VECTORS,
            "magnE": [np.array([1.0, 2]), np.array([3.0, 4])],
            "gmsh:physical": tags,
            "gmsh:geometrical": tags,
        },
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=True)


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [True, False])
def test_versions_as_text_and_binary_from_gmsh(file: Path, version: float, binary: bool) -> None:
    write(file)
    target = file.with_name("again.msh")
    rewrite_by_gmsh(file, target, version=version, binary=binary)
    _require_all(target)


def test_what_meshio_and_simnibs_write(file: Path) -> None:
    write(file)
    _require_all(file)


def _require_all(path: Path) -> None:
    mesh, findings = read_msh(path, "m")
    assert findings == ()
    data = {each.name: each for each in mesh.data}
    assert {name: each.where for name, each in data.items()} == {"v": "nodes", "A": "nodes", "E": "elements", "magnE": "elements"}
    # gmsh numbers nodes anew, so what counts is what stands at the corners
    for found, wanted in ((mesh.triangles, TRIANGLES), (mesh.tetrahedra, TETRAHEDRA)):
        np.testing.assert_array_equal(mesh.nodes[found], 1000 * POINTS[wanted])
        np.testing.assert_array_equal(data["v"].values[found, 0], wanted)
    np.testing.assert_array_equal(data["E"].values, np.concatenate(VECTORS))


HEAD = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
NODES = "$Nodes\n4\n30 0 0 1\n10 0 0 0\n20 1 0 0\n7 0 1 0\n$EndNodes\n"
# a point, two triangles with different numbers of tags, a tetrahedron; in no order
ELEMENTS = "$Elements\n4\n9 2 2 1 1 10 20 7\n2 15 2 1 1 10\n5 2 3 1 1 4 10 20 30\n4 4 2 1 1 10 20 7 30\n$EndElements\n"


def data(rows: str, count: int, kind: str = "Element", components: int = 1, name: str = '"E"') -> str:
    return f"${kind}Data\n1\n{name}\n1\n0.0\n3\n0\n{components}\n{count}\n{rows}$End{kind}Data\n"


def read(path: Path, text: str) -> FieldMesh:
    path.write_text(HEAD + text, encoding="latin-1")
    return read_msh(path, "mm")[0]


def test_numbers_decide_and_not_the_order_of_the_file(file: Path) -> None:
    mesh = read(file, "$Comments\nhello\n$EndComments\n" + NODES + ELEMENTS + data("4 40\n2 20\n9 90\n5 50\n", 4))
    np.testing.assert_array_equal(mesh.nodes, [[0, 1, 0], [0, 0, 0], [1, 0, 0], [0, 0, 1]])  # by number: 7, 10, 20, 30
    np.testing.assert_array_equal(mesh.triangles, [[1, 2, 0], [1, 2, 3]])  # numbers 9 and 5, as the file has them
    np.testing.assert_array_equal(mesh.data[0].values[:, 0], [90, 50, 40])


def test_what_is_left_out_is_told(file: Path) -> None:
    tensor = data("9 1 2 3 4 5 6 7 8 9\n", 1, components=9, name='"stress"')
    file.write_text(HEAD + NODES + ELEMENTS + data("9 1\n5 1\n4 1\n", 3) + tensor)
    _, findings = read_msh(file, "mm")
    assert [(each.code, each.count) for each in findings] == [("msh.elements_left_out", 1), ("msh.data_left_out", 1)]


def test_data_on_all_tetrahedra_alone_is_whole(file: Path) -> None:
    values = read(file, NODES + ELEMENTS + data("4 7\n", 1)).data[0].values[:, 0]
    np.testing.assert_array_equal(values, [np.nan, np.nan, 7])


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        (NODES + ELEMENTS, "msh.no_data", "no field"),
        (ELEMENTS + data("9 1\n5 1\n4 1\n", 3), "msh.no_nodes", "no nodes"),
        (NODES + ELEMENTS + data("9 1\n5 1\n4 1\n", 4), "msh.count_mismatch", "announces 4 rows"),
        (NODES + ELEMENTS + data("9 1\n4 1\n", 2), "msh.count_mismatch", "2 triangles and 1 tetrahedra"),
        (NODES + ELEMENTS + data("10 1\n", 1, "Node"), "msh.count_mismatch", "4 nodes"),
        (NODES + ELEMENTS + data("9 1\n5 1\n5 1\n", 3), "msh.duplicate_id", "5 is there twice"),
        (NODES + ELEMENTS + data("9 1\n5 1\n-4 1\n", 3), "msh.unknown_id", "first number -4"),
        (NODES.replace("30 ", "10 ") + ELEMENTS + data("4 1\n", 1), "msh.duplicate_id", "node 10"),
        (NODES + ELEMENTS.replace("10 20 7 30", "10 20 7 31") + data("4 1\n", 1), "msh.unknown_id", "31"),
        (NODES.replace("0 0 1", "0 nan 1") + ELEMENTS + data("4 1\n", 1), "msh.not_finite", "1 nodes"),
        (NODES.replace("4\n", "9\n") + ELEMENTS, "msh.corrupt", "9 nodes were announced"),
        (NODES + ELEMENTS.replace("\n4\n", "\n4000000000\n"), "msh.truncated", "3999999996 of 4000000000"),
        (NODES + ELEMENTS.replace("\n4\n", "\n3\n"), "msh.corrupt", "9 numbers follow"),
        (NODES + ELEMENTS.replace("9 2 2", "9 77 2"), "msh.corrupt", "type 77"),
        (NODES + ELEMENTS.replace("9 2 2", "9 2 -2"), "msh.corrupt", "-2 tags"),
        (NODES + ELEMENTS.replace("7 30", "x 30"), "msh.corrupt", "something else than numbers"),
        (NODES + ELEMENTS.replace("$EndElements", ""), "msh.truncated", "no end"),
        (NODES + ELEMENTS + data("9 1\n", 1, components=0), "msh.corrupt", "0 components"),
        ("$Nodes\n" + "1" * 5000, "msh.truncated", "no end"),
    ],
)
def test_lies_are_named(file: Path, text: str, code: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        read(file, text)
    assert caught.value.code == code


@pytest.mark.parametrize(
    ("head", "code"),
    [("$MeshFormat\n3.0 0 8\n", "msh.unsupported"), ("$MeshFormat\n2.2 1 4\n", "msh.unsupported"), ("$Nodes\n", "msh.corrupt")],
)
def test_other_formats_are_refused(file: Path, head: str, code: str) -> None:
    file.write_text(head + "$EndMeshFormat\n")
    with pytest.raises(InputError) as caught:
        read_msh(file, "mm")
    assert caught.value.code == code


def binary_file(blocks: bytes, total: int) -> bytes:
    nodes = b"".join(struct.pack(">i3d", number + 1, *point) for number, point in enumerate(POINTS))
    values = b"".join(struct.pack(">id", number, 10.0 * number) for number in (3, 1, 2))
    return (
        *(b"$MeshFormat\n2.2 1 8\n", struct.pack(">i", 1), b"\n$EndMeshFormat\n$Nodes\n5\n", nodes, b"\n$EndNodes\n"),
        *(b"$Elements\n%d\n" % total, blocks, b"\n$EndElements\n"),
        *(b'$ElementData\n1\n"E"\n1\n0\n3\n0\n1\n3\n', values, b"\n$EndElementData\n"),
    )  # type: ignore[return-value]


def test_blocks_of_one_element_and_the_other_order_of_bytes(file: Path) -> None:
    """As gmsh itself writes 2.2: a header for every element."""
    one = struct.pack(">8i", 2, 1, 1, 1, 0, 1, 2, 3) + struct.pack(">8i", 2, 1, 1, 2, 0, 2, 3, 5)
    blocks = one + struct.pack(">9i", 4, 1, 1, 3, 0, 1, 2, 3, 4)
    file.write_bytes(b"".join(binary_file(blocks, 3)))
    mesh, _ = read_msh(file, "mm")
    np.testing.assert_array_equal(mesh.triangles, TRIANGLES)
    np.testing.assert_array_equal(mesh.tetrahedra, TETRAHEDRA[:1])
    np.testing.assert_array_equal(mesh.data[0].values[:, 0], [10, 20, 30])


@pytest.mark.parametrize(("count", "total"), [(2_000_000_000, 2_000_000_000), (0, 3), (-1, 3), (5, 3)])
def test_blocks_that_lie_are_refused(file: Path, count: int, total: int) -> None:
    file.write_bytes(b"".join(binary_file(struct.pack(">3i", 2, count, 2), total)))
    with pytest.raises(InputError) as caught:
        read_msh(file, "mm")
    assert caught.value.code in {"msh.truncated", "msh.corrupt"}


def test_any_cut_is_an_error_with_a_name(file: Path) -> None:
    write(file)
    whole = file.read_bytes()
    for end in range(1, whole.index(b"$ElementData"), 7):
        file.write_bytes(whole[:end])
        with pytest.raises(InputError):
            read_msh(file, "mm")
