"""Labels of voxels over HTTP: uploaded as NIfTI or MGZ, made into nested surfaces, filled with tetrahedra."""

from __future__ import annotations

import httpx
import numpy as np
import pytest

from core.geometry.exact_intersection import find_intersecting_faces
from tests.acceptance.service import Service, unpack_shells
from tests.core.io.mgh_bytes import mgh
from tests.core.io.nifti_bytes import nifti, packed, two_boxes
from tests.core.segmentation.labelled_solids import centred, oblique, side_by_side, spheres

AFFINE = centred(9.0, (1.2, 1.0, 1.4), oblique())
NAMES = {"1": "skin", "2": "bone", "3": "white_matter"}


@pytest.fixture
def labels(service: Service) -> str:
    """A head of three tissues."""
    volume = spheres((9.0, 7.0, 4.5), AFFINE)
    return service.upload_file(packed(nifti(volume.labels, AFFINE)), "head.nii.gz", "mm")


def test_labels_become_a_package_that_can_be_filled(service: Service, labels: str) -> None:
    told = service.http.get(labels).json()
    assert (told["format"], told["faces"]) == ("nifti", 0)
    assert [row["label"] for row in told["volume"]["labels"]] == [1, 2, 3]
    job = service.execute("segment", {"volume": {"href": labels}, "names": NAMES})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    assert service.report(job)["nesting"] == {"skin": None, "bone": "skin", "white_matter": "bone"}
    surfaces = unpack_shells(service.result(job, "package"))
    assert set(surfaces) == set(NAMES.values())
    for mesh in surfaces.values():
        assert len(find_intersecting_faces(mesh.vertices, mesh.faces)) == 0
    assert np.abs(np.linalg.norm(surfaces["bone"].vertices, axis=1) - 7.0).max() < 0.7
    filled = service.execute("tetrahedralize", {"package": {"href": f"/v1/jobs/{job}/results/package"}})
    assert service.succeed(filled)["verdict"] == "simulation_ready"
    assert set(service.report(filled)["regions"]) == set(NAMES.values())


def test_labels_that_lie_side_by_side_become_shells(service: Service) -> None:
    volume = side_by_side()
    href = service.upload_file(packed(nifti(volume.labels, volume.affine)), "ball.nii.gz", "mm")
    asked = {"volume": {"href": href}, "inside": {"label_3": "label_2", "label_2": "label_1"}}
    job = service.execute("segment", asked)
    assert service.succeed(job)["verdict"] == "simulation_ready"
    assert service.report(job)["nesting"] == {"label_1": None, "label_2": "label_1", "label_3": "label_2"}


def test_labels_of_freesurfer_become_surfaces_where_its_header_says(service: Service) -> None:
    volume = spheres((6.0, 4.0), centred(6.0, (1.0, 1.0, 1.0)))
    href = service.upload_file(packed(mgh(volume.labels, middle=(30.0, -20.0, 10.0))), "aparc+aseg.mgz", "mm")
    told = service.http.get(href).json()
    assert (told["format"], told["name"]) == ("mgh", "aparc+aseg")
    job = service.execute("segment", {"volume": {"href": href}})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    skin = unpack_shells(service.result(job, "package"))["label_1"]
    # how far the ball's middle lies from that of the volume along i, j and k, which run to the left, down and forward
    i, j, k = np.linalg.inv(volume.affine)[:3, 3] - np.array(volume.labels.shape) / 2
    assert skin.vertices.mean(axis=0) == pytest.approx(np.array([30.0 - i, -20.0 + k, 10.0 - j]), abs=0.15)


def test_a_volume_is_no_mesh_and_a_mesh_no_volume(service: Service, labels: str, skin: str) -> None:
    def refused(process: str, inputs: object) -> str:
        reply = service.http.post(f"/v1/processes/{process}/execution", json={"inputs": inputs})
        assert reply.status_code == 422
        return str(reply.json()["code"])

    assert refused("shells", {"skin": {"href": labels}}) == "reference.not_a_mesh"
    assert refused("segment", {"volume": {"href": skin}}) == "reference.not_a_volume"
    assert refused("segment", {"volume": {"href": labels}, "names": {"0": "air"}}).startswith("inputs.")
    for path in (f"{labels}/file?format=stl", f"{labels}/ears"):
        reply = service.http.get(path)
        assert (reply.status_code, reply.json()["code"]) == (422, "mesh.is_a_volume")
    original = service.http.get(f"{labels}/file")
    assert original.content[:2] == b"\x1f\x8b"


def test_outputs_are_known_where_names_are(service: Service, labels: str) -> None:
    inputs = {"volume": {"href": labels}, "names": NAMES}
    reply: httpx.Response = service.http.post("/v1/processes/segment/execution", json={"inputs": inputs, "outputs": {"fat": {}}})
    assert (reply.status_code, reply.json()["code"]) == (422, "outputs.unknown")


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (nifti(two_boxes() * np.float32(0.5), AFFINE), "volume.not_integer"),
        (nifti(np.ones((3, 3, 3, 2), dtype=np.uint8), AFFINE), "nifti.dimensions"),
        (nifti(np.ones((1, 1, 1), dtype=np.uint8), AFFINE), "volume.one_voxel"),
        (packed(nifti(two_boxes(), AFFINE))[:-5], "volume.truncated"),
        (b"\x1f\x8b" + bytes(100), "volume.truncated"),
        (packed(mgh(two_boxes(), frames=4)), "mgh.frames"),
    ],
)
def test_what_holds_no_labels_is_refused_by_name(service: Service, content: bytes, code: str) -> None:
    reply = service.http.post("/v1/meshes", files={"file": ("labels.nii.gz", content, "application/octet-stream")})
    assert (reply.status_code, reply.json()["code"]) == (422, code), reply.text


def test_absurd_sizes_are_refused_as_too_large(service: Service) -> None:
    content = packed(mgh(two_boxes(), shape=(9999, 9999, 9999)))
    reply = service.http.post("/v1/meshes", files={"file": ("aseg.mgz", content, "application/octet-stream")})
    assert (reply.status_code, reply.json()["code"]) == (413, "volume.too_large"), reply.text


def test_a_label_that_is_not_there_fails_the_job_with_a_report(service: Service, labels: str) -> None:
    job = service.execute("segment", {"volume": {"href": labels}, "names": {"8": "fat"}})
    status = service.wait(job)
    assert (status["status"], status["failure"]["code"]) == ("failed", "segment.label_missing")
    assert "the volume has 1, 2, 3" in service.report(job)["summary"]
