"""One good file of every kind, made here: what a fuzzer starts from."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import zipfile
import zlib
from collections.abc import Callable
from functools import cache
from io import BytesIO
from pathlib import Path

import h5py
import meshio
import numpy as np

from core.io.registry import write_mesh
from core.package.archive import EARLIEST_DATE
from core.package.manifest import FILE_NAME, Manifest, TissueEntry
from subjects.figure_eight import figure_eight, write_ccd
from tests.core.io import matlab_bytes as craft
from tests.core.io.mgh_bytes import mgh
from tests.core.io.nifti_bytes import nifti, packed, two_boxes
from tests.core.io.stl_bytes import binary_stl
from tests.core.io.tiny import TETRAHEDRON
from tests.fuzz.headers import SEEDS as SEEDS_OF_HEADERS
from tests.fuzz.readers import folder
from tests.fuzz.requests import seeds_of_requests

P, T = TETRAHEDRON.vertices, TETRAHEDRON.faces + 1.0
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n100 0 0\n0 100 0\n0 0 100\n4 0 1 2 3\n3 0 1 3\n"
)


def written(name: str) -> bytes:
    """By our own writer."""
    path = folder() / "good"
    write_mesh(TETRAHEDRON, path, name, "skin")
    return path.read_bytes()


def mat73(**options: object) -> bytes:
    """HDF5 as h5py writes it."""
    stream = BytesIO()
    with h5py.File(stream, "w") as content:
        for name, array in (("P", P), ("t", T)):
            content.create_dataset(name, data=array.T, **options).attrs["MATLAB_class"] = np.bytes_("double")
    return stream.getvalue()


def package() -> bytes:
    """The smallest package: one surface and its manifest."""
    surface = binary_stl()
    tissue = TissueEntry(
        name="skin",
        file="stl/skin.stl",
        sha256=hashlib.sha256(surface).hexdigest(),
        mat_file="mat/skin.mat",
        mat_sha256="0" * 64,
        vertices=4,
        faces=4,
        depth_mm=None,
        conductivity_s_per_m=0.2,
        conductivity_source="by hand",
        enclosing_tissue="FreeSpace",
    )
    manifest = Manifest(
        process="shells", verdict="not_ready", tissues=(tissue,), parameters={}, input_sha256={}, software={}, files={}
    )
    stream = BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as small:
        small.writestr(zipfile.ZipInfo(FILE_NAME, EARLIEST_DATE), manifest.model_dump_json())
        small.writestr(zipfile.ZipInfo(tissue.file, EARLIEST_DATE), surface)
    return stream.getvalue()


def msh(file_format: str, *, binary: bool) -> bytes:
    """A tetrahedron with data on its corners and on itself, as meshio writes it."""
    path = folder() / "good.msh"
    data = {"E": np.arange(12.0).reshape(4, 3)}
    cells = [("tetra", np.array([[0, 1, 2, 3]]))]
    mesh = meshio.Mesh(P.astype(float), cells, point_data=data, cell_data={"v": [np.array([[1.0]])]})
    meshio.write(path, mesh, file_format=file_format, binary=binary)
    return re.sub(rb"np\.float64\(([^)]*)\)", rb"\1", path.read_bytes())  # what meshio writes as text under numpy 2


def ccd() -> bytes:
    """A coil as a table of dipoles."""
    path = folder() / "good.ccd"
    write_ccd(figure_eight(), path)
    return path.read_bytes()


def tcd() -> bytes:
    """A coil as JSON, its rows packed and not."""
    packed = base64.b64encode(zlib.compress(np.arange(6.0).tobytes())).decode()
    elements = [
        {"type": 1, "points": [[0, 0, 0], [1, 0, 0]], "values": [[0, 0, 1], [0, 1, 0]]},
        {"type": 1, "points": packed, "values": packed},
    ]
    return json.dumps({"name": "coil", "coilElementList": elements, "stimulatorList": [{"name": "any"}]}).encode()


SEEDS: dict[str, tuple[Callable[[], bytes], ...]] = {
    "stl": (lambda: written("stl"), lambda: written("stl-ascii")),
    "mat": (
        lambda: written("mat"),
        lambda: craft.mat_file(craft.compressed(craft.matrix("P", P)), craft.compressed(craft.matrix("t", T))),
        lambda: craft.mat_file(craft.matrix("P", P, order=">"), craft.matrix("t", T, order=">"), order=">"),
        lambda: craft.mat_file(craft.matrix("P", P), craft.matrix("t", T), craft.matrix("d", P[:, :1])),
    ),
    "hdf5": (mat73, lambda: mat73(chunks=(3, 2), compression="gzip", shuffle=True, fletcher32=True)),
    "ply": (lambda: written("ply"), PLY.encode),
    "obj": (lambda: written("obj"), lambda: b"v 0 0 0\nv 9 0 0 1 .5 1\nv 0 9 0\nv 0 0 9\nf 1/1/1 2//2 3 -1\n\nf 1 \\\n2 4\n"),
    "nifti": (
        lambda: nifti(two_boxes(), np.diag([2.0, -1.0, 3.0, 1.0])),
        lambda: packed(nifti(two_boxes().astype("i4"), np.eye(4), version=2, order=">", slope=2.0)),
        lambda: nifti(two_boxes().astype("f4"), quaternion=(0.5, 0.5, 0.5, 1.0, 2.0, 3.0), units=0),
    ),
    "mgh": (
        lambda: mgh(two_boxes(), sides=(1.0, 2.0, 3.0), middle=(4.0, 5.0, 6.0), tail=bytes(20)),
        lambda: packed(mgh(two_boxes().astype("f4"))),
        lambda: mgh(two_boxes().astype("i2"), placed=0),
    ),
    "msh": (
        lambda: msh("gmsh22", binary=True),
        lambda: msh("gmsh22", binary=False),
        lambda: msh("gmsh", binary=True),
        lambda: msh("gmsh", binary=False),
    ),
    "tcd": (tcd,),
    "ccd": (ccd,),
    "table": (lambda: b"x,y,z,E\n0,0,0,1\n1,2,3,nan\n", lambda: b"% a comment\n1 2 3\n4 5e-3 -6\n"),
    "unnamed": (lambda: written("stl"), lambda: written("stl-ascii")),
    "package": (package,),
}


@cache
def seeds(target: str) -> tuple[bytes, ...]:
    """Good inputs of a target."""
    if target == "requests":
        return seeds_of_requests()
    return SEEDS_OF_HEADERS if target == "headers" else tuple(make() for make in SEEDS[target])


def corpus(target: str) -> list[Path]:
    """Files kept because they once crashed the target or reach far into it."""
    return sorted((Path(__file__).parent / "corpus" / target).glob("*"))
