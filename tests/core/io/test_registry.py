from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from core.errors import InputError
from core.io.registry import FORMATS, WRITERS, read_meshes, write_mesh
from core.io.unit import Unit, require_unit
from core.mesh import LARGEST_COORDINATE_MM, Mesh
from tests.core.io import matlab_bytes as craft
from tests.core.io.stl_bytes import binary_stl
from tests.core.io.tiny import CORNERS_MM, TETRAHEDRON, TRIANGLES

FILE_NAME = {"stl": "skin.stl", "stl-ascii": "skin.STL", "mat": "skin.mat", "ply": "skin.Ply", "obj": "a.b.obj"}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "upload"


@pytest.mark.parametrize("format_name", WRITERS)
@given(
    points=hnp.arrays(
        np.float32, (4, 3), elements=st.floats(-LARGEST_COORDINATE_MM, LARGEST_COORDINATE_MM, width=32), unique=True
    )
)
def test_what_is_written_is_read_again_bit_for_bit(
    tmp_path_factory: pytest.TempPathFactory, format_name: str, points: np.ndarray
) -> None:
    file = tmp_path_factory.mktemp("round") / "upload"
    mesh = Mesh.of(points, TRIANGLES)
    write_mesh(mesh, file, format_name, "skin")
    intake = read_meshes(file, file_name=FILE_NAME[format_name], unit="mm")
    (named,) = intake.meshes
    assert named.mesh.triangles().tobytes() == mesh.triangles().tobytes()
    assert intake.format == format_name.removesuffix("-ascii")


@pytest.mark.parametrize("format_name", FORMATS)
@pytest.mark.parametrize(("unit", "factor"), [("m", 1000.0), ("cm", 10.0), ("mm", 1.0), ("in", 25.4)])
def test_units_are_converted_to_mm(file: Path, format_name: str, unit: Unit, factor: float) -> None:
    write_mesh(TETRAHEDRON, file, format_name, "skin")
    mesh = read_meshes(file, file_name=FILE_NAME[format_name], unit=unit).meshes[0].mesh
    assert np.array_equal(mesh.triangles(), TETRAHEDRON.triangles() * factor)


def test_the_size_of_the_whole_upload_is_judged(file: Path) -> None:
    write_mesh(TETRAHEDRON.with_vertices(TETRAHEDRON.vertices / 100), file, "stl", "skin")
    (finding,) = read_meshes(file, file_name="left ear.stl", unit="mm").findings
    assert finding.code == "mesh.unit_suspicious"
    assert finding.message.startswith("left ear is 1 mm long")
    assert read_meshes(file, file_name="left ear.stl", unit="m").findings == ()


def test_names_come_from_the_solids_if_there_are_several(file: Path, tmp_path: Path) -> None:
    parts = []
    for name in ("ear", "ear", ""):
        write_mesh(TETRAHEDRON, tmp_path / "part", "stl-ascii", name)
        parts.append((tmp_path / "part").read_bytes())
    file.write_bytes(b"".join(parts))
    assert [named.name for named in read_meshes(file, file_name="head.stl", unit="mm").meshes] == ["ear", "ear_2", "head"]
    file.write_bytes(parts[0])
    assert [named.name for named in read_meshes(file, file_name="head.stl", unit="mm").meshes] == ["head"]
    assert [named.name for named in read_meshes(file, file_name="\n\0.stl", unit="mm").meshes] == ["mesh"]


BAD_COORDINATES = [(np.nan, "mesh.not_finite"), (-np.inf, "mesh.not_finite"), (1e300, "mesh.coordinate_out_of_range")]


def with_value(value: float) -> dict[str, bytes]:
    """The tetrahedron in every format, z of vertex 3 replaced."""
    corners = np.array(CORNERS_MM)
    corners[3, 2] = value
    rows = "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in corners.tolist())
    vertex_lines = "".join(f"v {row}\n" for row in rows.splitlines())
    face_lines = "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in TRIANGLES)
    header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    header += "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    solid = "solid\n"
    for face in TRIANGLES:
        vertices = "".join(f"vertex {rows.splitlines()[corner]}\n" for corner in face)
        solid += f"facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n"
    return {
        "a.obj": (vertex_lines + face_lines).encode(),
        "a.ply": (header + rows + "".join(f"3 {a} {b} {c}\n" for a, b, c in TRIANGLES)).encode(),
        "a.stl": (solid + "endsolid\n").encode(),
        "a.mat": craft.mat_file(craft.matrix("P", corners), craft.matrix("t", np.array(TRIANGLES) + 1.0)),
    }


@pytest.mark.parametrize(("value", "code"), BAD_COORDINATES)
@pytest.mark.parametrize("file_name", ["a.obj", "a.ply", "a.stl", "a.mat"])
@pytest.mark.parametrize("unit", ["m", "mm"])
def test_coordinates_that_are_no_places_are_refused(file: Path, file_name: str, value: float, code: str, unit: Unit) -> None:
    file.write_bytes(with_value(value)[file_name])
    with pytest.raises(InputError) as caught:
        read_meshes(file, file_name=file_name, unit=unit)
    assert caught.value.code == code
    assert "vertex 3" in caught.value.message
    assert caught.value.facts["first_face"] == 1


@pytest.mark.parametrize(
    ("value", "code"), [(np.nan, "mesh.not_finite"), (np.inf, "mesh.not_finite"), (3e38, "mesh.coordinate_out_of_range")]
)
def test_binary_stl_coordinates_that_are_no_places_are_refused(file: Path, value: float, code: str) -> None:
    content = bytearray(binary_stl())
    content[84 + 12 : 84 + 16] = np.float32(value).tobytes()
    file.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_meshes(file, file_name="a.stl", unit="m")
    assert (caught.value.code, caught.value.facts["first_face"]) == (code, 0)


def test_the_limit_of_coordinates_is_in_mm(file: Path) -> None:
    write_mesh(TETRAHEDRON.with_vertices(TETRAHEDRON.vertices * 1e3), file, "stl", "a")  # 100 km, if given in m
    with pytest.raises(InputError, match="100000 m is beyond the limit of 10000 m") as caught:
        read_meshes(file, file_name="a.stl", unit="m")
    assert caught.value.code == "mesh.coordinate_out_of_range"


@pytest.mark.parametrize(
    ("content", "file_name", "code", "words"),
    [
        (b"", "a.stl", "upload.empty", "0 bytes"),
        (b"words", "a.xyz", "format.unknown", "'a.xyz' is in no known format; known are .stl, .mat, .ply, .obj"),
        (b"words", "no extension", "format.unknown", "no known format"),
        (b"PK\x03\x04" + bytes(99), "a.stl", "format.unknown", "a zip archive"),
        (b"\x1f\x8b" + bytes(99), "a.ply", "format.unknown", "gzip-compressed"),
        (b"ply\nformat ascii 1.0\n", "a.stl", "format.mismatch", "'a.stl' says stl, the content is ply"),
        (craft.mat_file(), "a.obj", "format.mismatch", "says obj, the content is mat"),
        (b"\x89HDF\r\n\x1a\n" + bytes(99), "a.ply", "format.mismatch", "the content is mat"),
        (b"words", "a.ply", "ply.truncated", "end_header"),
        (b"words", "a.mat", "mat.corrupt", "5 bytes"),
        (b"words", "a.stl", "stl.not_stl", "5 bytes"),
        (b"words", "a.obj", "obj.malformed", "line 1"),
    ],
)
def test_the_content_must_agree_with_the_name(file: Path, content: bytes, file_name: str, code: str, words: str) -> None:
    file.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_meshes(file, file_name=file_name, unit="mm")
    assert (caught.value.code, words in caught.value.message) == (code, True), caught.value.message


@pytest.mark.parametrize("format_name", ["stl", "stl-ascii", "mat", "ply"])
def test_names_without_extension_go_by_content(file: Path, format_name: str) -> None:
    write_mesh(TETRAHEDRON, file, format_name, "skin")
    assert read_meshes(file, file_name="skin", unit="mm").format == format_name.removesuffix("-ascii")


def test_the_size_of_a_binary_stl_outweighs_any_signature(file: Path) -> None:
    for header in (b"ply\nformat ascii 1.0\n", b"PK\x03\x04", b"\x89HDF\r\n\x1a\n", b"solid"):
        file.write_bytes(binary_stl(header=header))
        assert read_meshes(file, file_name="a.stl", unit="mm").format == "stl"


def test_other_formats_and_units_are_refused(file: Path) -> None:
    with pytest.raises(InputError, match="'step' is not known; use one of stl, mat, ply, obj, stl-ascii, glb, vtu") as caught:
        write_mesh(TETRAHEDRON, file, "step", "skin")
    assert caught.value.code == "format.unknown"
    assert not file.exists()
    with pytest.raises(InputError, match="'feet' is not known; use one of m, cm, mm, in") as caught:
        require_unit("feet")
    assert caught.value.code == "unit.unknown"
