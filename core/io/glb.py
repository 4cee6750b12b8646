"""GLB, the binary form of glTF 2.0: coloured surfaces for viewers and for slides. Written only."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import vertex_normals
from core.io.naming import clean_name
from core.mesh import Mesh

MAGIC, VERSION = 0x46546C67, 2
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942
FLOAT, UNSIGNED_INT = 5126, 5125
VERTEX_DATA, INDEX_DATA = 34962, 34963
METRES_PER_MM = 0.001
GREY = (176, 176, 176)


@dataclass(frozen=True, eq=False, slots=True)
class GlbPart:
    """One surface. colour: sRGB, 0 to 255; opacity: 1 for what nothing shines through."""

    name: str
    mesh: Mesh
    colour: tuple[int, int, int] = GREY
    opacity: float = 1.0


def write(mesh: Mesh, path: Path, name: str) -> None:
    """One node. Coordinates are rounded to float32."""
    path.write_bytes(glb_bytes([GlbPart(clean_name(name, "mesh"), mesh)]))


def glb_bytes(parts: Sequence[GlbPart]) -> bytes:
    """A node, a mesh and a material per part, all under its name; the same parts, the same bytes.

    Positions are the float32 millimetres of the other files; each node is scaled to the metres that glTF asks for. Axes stay as
    they are, though viewers take y for up. Source: glTF 2.0 specification, ISO/IEC 12113:2022.
    """
    arrays = [array for part in parts for array in _arrays(part.mesh)]
    starts = np.cumsum([0, *(array.nbytes for array in arrays)]).tolist()
    numbers = range(len(parts))
    document = {
        "asset": {"version": "2.0", "generator": "Integument"},
        "scene": 0,
        "scenes": [{"nodes": list(numbers)}],
        "nodes": [{"name": part.name, "mesh": number, "scale": [METRES_PER_MM] * 3} for number, part in enumerate(parts)],
        "meshes": [{"name": part.name, "primitives": [_primitive(number)]} for number, part in enumerate(parts)],
        "materials": [_material(part) for part in parts],
        "accessors": [_accessor(number, array) for number, array in enumerate(arrays)],
        "bufferViews": [
            {
                "buffer": 0,
                "byteOffset": start,
                "byteLength": array.nbytes,
                "target": INDEX_DATA if array.ndim == 1 else VERTEX_DATA,
            }
            for start, array in zip(starts, arrays, strict=False)
        ],
        "buffers": [{"byteLength": starts[-1]}],
    }
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=True).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(array.tobytes() for array in arrays)  # whole numbers of four bytes
    head = struct.pack("<III", MAGIC, VERSION, 12 + 8 + len(text) + 8 + len(binary))
    return b"".join((head, _chunk(JSON_CHUNK, text), _chunk(BINARY_CHUNK, binary)))


def _chunk(kind: int, data: bytes) -> bytes:
    return struct.pack("<II", len(data), kind) + data


def _arrays(mesh: Mesh) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.uint32]]:
    """Positions, normals, corners."""
    normals = vertex_normals(mesh.vertices, mesh.faces).astype("<f4")
    normals[~(np.abs((normals**2).sum(axis=1) - 1) < 1e-3)] = (0, 0, 1)  # of flat fans and vertices without a face
    return mesh.vertices.astype("<f4"), normals, mesh.faces.astype("<u4").ravel()


def _primitive(number: int) -> dict[str, Any]:
    first = 3 * number
    return {"attributes": {"POSITION": first, "NORMAL": first + 1}, "indices": first + 2, "material": number}


def _material(part: GlbPart) -> dict[str, Any]:
    linear = [round(float(_linear(channel / 255)), 6) for channel in part.colour]
    factors = {"baseColorFactor": [*linear, part.opacity], "metallicFactor": 0.0, "roughnessFactor": 0.8}
    return {
        "name": part.name,
        "pbrMetallicRoughness": factors,
        "alphaMode": "OPAQUE" if part.opacity == 1.0 else "BLEND",
    }


def _linear(channel: float) -> float:
    """From sRGB, in which colours are named, to the light that glTF counts in."""
    return channel / 12.92 if channel <= 0.04045 else float(((channel + 0.055) / 1.055) ** 2.4)


def _accessor(number: int, array: NDArray[Any]) -> dict[str, Any]:
    described = {"bufferView": number, "count": len(array), "componentType": UNSIGNED_INT if array.ndim == 1 else FLOAT}
    if array.ndim == 1:
        return {**described, "type": "SCALAR"}
    bounds = {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()} if number % 3 == 0 else {}
    return {**described, "type": "VEC3", **bounds}
