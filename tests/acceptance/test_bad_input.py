"""What a stranger gets wrong, over HTTP: refused by name, in words with the numbers of the very input."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from typing import Any

import httpx
import numpy as np
import pytest

from core.mesh import Mesh
from tests.acceptance.service import Service
from tests.core.io.nifti_bytes import nifti, packed, two_boxes
from tests.solids import sphere

AFFINE = np.diag([2.0, 2.0, 2.0, 1.0])
FLAT = np.array([[1, 1, 0, 0], [1, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], dtype=float)
SKIN = sphere(50.0, 3)
LAYERS = [{"name": "fat", "depth_mm": 1.0}, {"name": "average_body", "depth_mm": 3.0}]

UPLOADS: Mapping[str, tuple[str, bytes, str, str]] = {  # what is wrong -> file name, content, code, words
    "one voxel": ("a.nii.gz", packed(nifti(np.ones((1, 1, 1), np.uint8), AFFINE)), "volume.one_voxel", "1 x 1 x 1 voxels"),
    "one slice": ("a.nii", nifti(np.ones((5, 4, 1), np.uint8), AFFINE), "volume.one_voxel", "5 x 4 x 1 voxels"),
    "no label": ("a.nii", nifti(np.zeros((5, 4, 3), np.uint8), AFFINE), "volume.no_labels", "all 60 voxels"),
    "float labels": (
        "a.nii",
        nifti(two_boxes() * np.float32(0.5), AFFINE),
        "volume.not_integer",
        r"\d+ values .* the first is 0\.5",
    ),
    "4D": ("a.nii", nifti(np.ones((3, 4, 5, 2), np.uint8), AFFINE), "nifti.dimensions", "3 x 4 x 5 x 2 values"),
    "affine turned flat": ("a.nii", nifti(two_boxes(), FLAT), "volume.affine_singular", r"1 1 0 0; 1 1 0 0; 0 0 1 0"),
    "fewer voxels than told": ("a.nii", nifti(two_boxes(), AFFINE)[:-7], "volume.truncated", r"\d+ of \d+ bytes"),
    "rows of two lengths": ("a.csv", b"x,y,z,E\n1,2,3,4\n1,2,3\n", "table.ragged", "line 3 or near it has not the 4 columns"),
    "more values than rows": (
        "a.msh",
        b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 2 1 1 1 2 3\n"
        b'$EndElements\n$ElementData\n1\n"E"\n1\n0\n3\n0\n3\n2\n1 1 0 0\n$EndElementData\n',
        "msh.count_mismatch",
        "announces 2 rows of 3 components, but has 4 numbers",
    ),
    "fewer dipoles than told": (
        "a.ccd",
        b"3\n0 0 0 0 0 1\n0.05 0 0 0 0 1\n",
        "coil.count_mismatch",
        "announces 3 dipoles and has 2",
    ),
    "more points than values": (
        "a.tcd",
        json.dumps(
            {"coilElementList": [{"type": 1, "stimulator": 0, "points": [[0, 0, 0], [50, 0, 0]], "values": [[0, 0, 1]]}]}
        ).encode(),
        "coil.count_mismatch",
        "2 points and 1 values",
    ),
}


@pytest.mark.parametrize("wrong", UPLOADS)
def test_files_are_refused_when_they_come(service: Service, wrong: str) -> None:
    name, content, code, words = UPLOADS[wrong]
    reply = service.http.post("/v1/meshes", files={"file": (name, content, "application/octet-stream")})
    assert (reply.status_code, reply.json()["code"]) == (422, code), reply.text
    assert re.search(words, reply.json()["detail"]), reply.json()["detail"]


def ball(radius: float, z: float = 0.0) -> Mesh:
    return sphere(radius, 2, at=(0.0, 0.0, z))


Asked = Callable[[Callable[[Mesh], dict[str, str]]], dict[str, Any]]
TISSUES: dict[str, Any] = {"heal": None, "tetrahedra": None, "layers": LAYERS}
JOBS: Mapping[str, tuple[str, Asked, str, str]] = {  # what is wrong -> process, inputs, code, words
    "tissue outside the skin": (
        "prepare",
        lambda up: {"skin": up(SKIN), "tissues": [{"name": "heart", "mesh": up(ball(10.0, 70.0))}], **TISSUES},
        "tissues.outside_skin",
        r"'heart' is not inside the skin: 66 of its 66 vertices \(100%\)",
    ),
    "tissues that cross": (
        "prepare",
        lambda up: {
            "skin": up(SKIN),
            "tissues": [{"name": "left", "mesh": up(ball(10.0))}, {"name": "right", "mesh": up(ball(10.0, 15.0))}],
            "separate": None,
            **TISSUES,
        },
        "tissues.cross",
        r"left and right .*\d+",
    ),
    "a tissue between the layers": (
        "prepare",
        lambda up: {"skin": up(SKIN), "tissues": [{"name": "speck", "mesh": up(ball(0.2, 48.4))}], **TISSUES},
        "tissues.outside_layers",
        "speck",
    ),
    "nested the other way round": (
        "separate",
        lambda up: {"meshes": {"skull": up(ball(9.0)), "brain": up(ball(8.0))}, "inside": {"skull": "brain"}},
        "separate.not_inside",
        r"skull is said to lie inside brain, but \d+% of it lies outside",
    ),
    "nested in a circle": (
        "separate",
        lambda up: {"meshes": {"skull": up(ball(9.0)), "brain": up(ball(8.0))}, "inside": {"skull": "brain", "brain": "skull"}},
        "separate.unordered",
        "inside itself: .*skull.*brain|inside itself: .*brain.*skull",
    ),
    "shells that cross": (
        "tetrahedralize",
        lambda up: {"meshes": {"skin": up(ball(10.0)), "fat": up(ball(9.0, 2.0))}},
        "tetrahedra.surfaces_unfit",
        r"skin and fat .*\d+|\d+ .*skin.*fat",
    ),
    "shells far across each other": (
        "separate",
        lambda up: {"meshes": {"skin": up(ball(10.0)), "fat": up(ball(10.0, 5.0))}},
        "separate.unclear_sides",
        r"\d+% of skin lies inside fat, \d+% of fat inside skin",
    ),
}


@pytest.mark.parametrize("wrong", JOBS)
def test_surfaces_are_refused_with_a_report(service: Service, wrong: str) -> None:
    process, asked, code, words = JOBS[wrong]
    job = service.execute(process, asked(lambda mesh: {"href": service.upload(mesh)}))
    failure = failed(service, job)
    assert failure["code"] == code, failure
    assert re.search(words, failure["message"]), failure["message"]
    assert service.report(job)["verdict"] == "not_ready"


def test_fields_without_the_columns_asked_for(service: Service) -> None:
    table = service.upload_file(b"x,y,z,Ex,Ey,phi\n1,2,3,4,5,6\n4,5,6,7,8,9\n", "field.csv", "mm")
    skin = {"href": service.upload(SKIN)}
    wanted: Mapping[str, tuple[dict[str, Any], str, str]] = {
        "by the header": ({}, "fields.columns_missing", "no column is called Ez.*x, y, z, Ex, Ey, phi"),
        "too many names": ({"columns": [*list("xyz"), "Ex", "Ey", "Ez", "-"]}, "fields.columns_differ", "7 columns .* has 6"),
    }
    for more, code, words in wanted.values():
        failure = failed(service, service.execute("fields", {"mesh": skin, "field": {"href": table}, **more}))
        assert failure["code"] == code
        assert re.search(words, failure["message"]), failure["message"]


def test_layers_in_the_wrong_order_are_told_where_they_are(service: Service) -> None:
    inputs = {"skin": {"href": service.upload(SKIN)}, "layers": LAYERS[::-1]}
    reply: httpx.Response = service.http.post("/v1/processes/shells/execution", json={"inputs": inputs})
    assert (reply.status_code, reply.json()["code"]) == (422, "inputs.invalid")
    assert "must increase inwards" in reply.text


def test_a_turned_affine_is_no_fault(service: Service) -> None:
    angle = np.radians(30.0)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    affine = np.eye(4)
    affine[:3, :3], affine[:3, 3] = turn * (2.0, 1.0, 3.0), (10.0, 20.0, 30.0)
    href = service.upload_file(nifti(two_boxes(), affine), "turned.nii", "mm")
    told = service.http.get(href).json()["volume"]
    assert told["voxel_mm"] == pytest.approx([2.0, 1.0, 3.0], rel=1e-6)


def failed(service: Service, job: str) -> dict[str, Any]:
    """Why a job that must fail did."""
    status = service.wait(job)
    assert status["status"] == "failed", status
    failure: dict[str, Any] = status["failure"]
    return failure
