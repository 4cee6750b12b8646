"""Wavefront OBJ: `v` and `f` only. Materials, textures, normals and groups are passed over and no other file is opened."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.errors import InputError
from core.io.indexed import assemble
from core.io.naming import clean_name
from core.io.polygons import check_polygons, fan
from core.io.reading import Reading
from core.mesh import Mesh

PASSED_OVER = frozenset(
    b"vt vn vp g o s usemtl mtllib l p mg usemap maplib lod shadow_obj trace_obj bevel c_interp d_interp".split()
)
LARGEST_INDEX = 2**53


def read(path: Path) -> Reading:
    """Read vertices (further values after x y z are dropped) and faces (`f 1/2/3 …`; negative counts from the latest vertex).

    Raises: InputError `obj.malformed`, `obj.zero_based`, `mesh.empty`, `mesh.index_out_of_range`.
    """
    vertices: list[tuple[float, float, float]] = []
    corners: list[int] = []
    counts: list[int] = []
    text = path.read_bytes().replace(b"\r\n", b"\n").replace(b"\r", b"\n").replace(b"\\\n", b" ")
    for number, line in enumerate(text.split(b"\n"), start=1):
        words = line.split()
        if not words or words[0].startswith(b"#"):
            continue
        try:
            if words[0] in (b"v", b"f") and b"_" in line:
                raise ValueError("a word is not a number")  # Python reads 1_000, OBJ does not know it
            if words[0] == b"v":
                vertices.append(_parse_vertex(words))
            elif words[0] == b"f":
                face = _parse_face(words, len(vertices))
                corners += face
                counts.append(len(face))
            elif words[0] not in PASSED_OVER:
                raise ValueError(f"unknown statement {clean_name(words[0][:24])!r}")
        except ValueError as error:
            raise InputError("obj.malformed", f"line {number}: {clean_name(str(error))}", line=number) from None
    face_counts = np.array(counts, dtype=np.int64)
    faces = fan(np.array(corners, dtype=np.int64), face_counts)
    return assemble(np.array(vertices).reshape(-1, 3), faces, tuple(check_polygons(face_counts)), base=1)


def write(mesh: Mesh, path: Path, name: str) -> None:
    """Write the shortest decimals that read back as the same float64. Same mesh and name, same bytes."""
    title = clean_name(name).encode("ascii", errors="replace").decode()
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"# Integument, millimetres, {title}\n")
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist())
        file.writelines(f"f {a} {b} {c}\n" for a, b, c in (mesh.faces + 1).tolist())


def _parse_vertex(words: list[bytes]) -> tuple[float, float, float]:
    if len(words) < 4:
        raise ValueError(f"a vertex of {len(words) - 1} numbers, 3 are needed")
    return float(words[1]), float(words[2]), float(words[3])


def _parse_face(words: list[bytes], vertex_count: int) -> list[int]:
    """Vertex numbers of one face, 0-based; too small or too large ones are found when all vertices are known."""
    if len(words) < 4:
        raise ValueError(f"a face of {len(words) - 1} corners, 3 are needed")
    numbers = [int(word.partition(b"/")[0]) for word in words[1:]]
    if 0 in numbers:
        raise InputError("obj.zero_based", "a face has index 0; OBJ counts vertices from 1", vertices_before=vertex_count)
    if max(numbers) >= LARGEST_INDEX or min(numbers) <= -LARGEST_INDEX:
        raise ValueError(f"an index is larger than {LARGEST_INDEX}")
    return [number - 1 if number > 0 else vertex_count + number for number in numbers]
