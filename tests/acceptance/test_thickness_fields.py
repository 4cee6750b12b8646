"""Layers on both sides of the skin, depths that come with the upload, and a skin that may move, over HTTP."""

import io
import json
import zipfile
from typing import Any

import numpy as np
import pytest
import scipy.io
from scipy.spatial import cKDTree

from core.geometry.distance import closest_points
from core.mesh import Mesh
from subjects.body import body
from tests.acceptance.service import Service, unpack_shells
from tests.acceptance.test_main_job import count_intersections

SKIN = body(0)
FAT_MM = 1.0 + 2.0 / (1.0 + np.exp((SKIN.vertices[:, 1] - 300.0) / 50.0))  # 1 mm on the head, 3 mm on legs and belly
GEL = {"name": "gel", "depth_mm": 1.0, "side": "outside"}
FAT = {"name": "fat", "depth_array": "fat_depth_mm"}
BODY = {"name": "average_body", "depth_mm": 5.0}


@pytest.fixture(scope="module")
def upload(service: Service) -> str:
    """The body in metres, with depths in millimetres and some that are none."""
    bad = FAT_MM.copy()
    bad[17] = np.nan
    arrays = {"fat_depth_mm": FAT_MM[:, None], "bad_mm": bad, "short_mm": FAT_MM[1:]}
    content = io.BytesIO()
    scipy.io.savemat(content, {"P": SKIN.vertices / 1000.0, "t": SKIN.faces + 1.0, **arrays}, do_compression=True)
    return service.upload_file(content.getvalue(), "body.mat", "m")


@pytest.fixture(scope="module")
def done(service: Service, upload: str) -> dict[str, Any]:
    job = service.shells(upload, layers=[GEL, FAT, BODY], skin_shift_mm=1.0)
    assert service.succeed(job)["verdict"] == "simulation_ready"
    package = service.result(job, "package")
    return {"job": job, "report": service.report(job), "package": package, "shells": unpack_shells(package)}


def test_the_upload_says_which_arrays_it_has(service: Service, upload: str) -> None:
    told = service.http.get(upload).json()
    assert [array["name"] for array in told["arrays"]] == ["bad_mm", "fat_depth_mm"]
    assert told["arrays"][0]["not_finite"] == 1
    assert told["arrays"][1]["maximum"] == pytest.approx(float(FAT_MM.max()))
    assert [finding["code"] for finding in told["findings"]] == ["mat.array_ignored"]


def test_the_layers_nest_around_and_below_the_skin(done: dict[str, Any]) -> None:
    shells: dict[str, Mesh] = done["shells"]
    assert set(shells) == {"gel", "skin", "fat", "average_body"}
    assert count_intersections(shells) == 0
    assert done["report"]["nesting"] == {"gel": None, "skin": "gel", "fat": "skin", "average_body": "fat"}
    with zipfile.ZipFile(io.BytesIO(done["package"])) as archive:
        tissues = json.loads(archive.read("manifest.json"))["tissues"]
        index = archive.read("bem-fmm/tissue_index.txt").decode()
    assert [tissue["name"] for tissue in tissues] == ["gel", "skin", "fat", "average_body"]
    assert [tissue["side"] for tissue in tissues] == ["outside", None, "inside", "inside"]
    assert [tissue["enclosing_tissue"] for tissue in tissues] == ["FreeSpace", "gel", "skin", "fat"]
    assert index.index("gel") < index.index("skin")


def test_each_place_has_the_depth_asked_for_there(done: dict[str, Any]) -> None:
    shells: dict[str, Mesh] = done["shells"]
    skin = shells["skin"]
    wanted = FAT_MM[cKDTree(SKIN.vertices).query(shells["fat"].vertices)[1]]
    distance = closest_points(skin.vertices, skin.faces, shells["fat"].vertices)[0]
    assert (np.abs(distance - wanted) <= 0.1 * wanted).mean() > 0.93
    around = closest_points(skin.vertices, skin.faces, shells["gel"].vertices)[0]
    assert (np.abs(around - 1.0) <= 0.05).mean() > 0.93
    thickness = done["report"]["thickness"]
    assert (thickness["fat"]["target_array"], thickness["gel"]["side"]) == ("fat_depth_mm", "outside")
    assert min(layer["on_target_area"] for layer in thickness.values()) > 0.97


def test_the_skin_moved_only_outwards_and_within_the_bound(done: dict[str, Any]) -> None:
    skin: Mesh = done["shells"]["skin"]
    change = done["report"]["changes"][-1]
    assert 0.5 < change["largest_mm"] <= 1.0
    given = cKDTree(SKIN.vertices)
    assert given.query(skin.vertices)[0].max() <= 1.0
    kept = given.query(skin.vertices)[0] == 0
    assert 0.7 < kept.mean() < 1.0  # bit for bit, through upload in metres and binary STL


def test_every_limited_area_is_told_painted_and_circled(service: Service, done: dict[str, Any]) -> None:
    codes = {finding["code"] for finding in done["report"]["findings"] if finding["places"]}
    assert {"shells.depth_limited", "skin.moved_outwards"} <= codes
    page = service.http.get(f"/v1/jobs/{done['job']}/report", headers={"Accept": "text/html"}).text
    with zipfile.ZipFile(io.BytesIO(done["package"])) as archive:
        names = archive.namelist()
        assert b"figure-places_fat" in archive.read("report/report.html")
    for surface in ("skin", "fat", "average_body"):
        assert f'id="figure-places_{surface}"' in page
        assert f"report/figures/places_{surface}.png" in names


@pytest.mark.parametrize(
    ("inputs", "code"),
    [
        ({"layers": [FAT | {"depth_array": "short_mm"}]}, "layer.array_missing"),
        ({"layers": [FAT | {"depth_array": "bad_mm"}]}, "layer.array_out_of_range"),
        ({"layers": [FAT, BODY | {"depth_mm": 2.0}]}, "layer.depths_out_of_order"),
    ],
)
def test_arrays_that_do_not_fit_fail_the_job_by_name(service: Service, upload: str, inputs: dict[str, Any], code: str) -> None:
    ended = service.wait(service.shells(upload, **inputs))
    assert (ended["status"], ended["failure"]["code"], ended["failure"]["class"]) == ("failed", code, "input")


@pytest.mark.parametrize(
    ("inputs", "pointer", "words"),
    [
        ({"skin_shift_mm": -1}, "/inputs/skin_shift_mm", "greater than or equal to 0"),
        ({"skin_shift_mm": 5.5}, "/inputs/skin_shift_mm", "less than or equal to 5"),
        ({"skin_shift_mm": "far"}, "/inputs/skin_shift_mm", "number"),
        ({"layers": [GEL | {"side": "beside"}]}, "/inputs/layers/0/side", "inside"),
        ({"layers": [FAT | {"depth_array": "P(:,1)"}]}, "/inputs/layers/0/depth_array", "pattern"),
        ({"layers": [FAT | {"depth_mm": 1}]}, "/inputs/layers/0", "either depth_mm or depth_array"),
        ({"layers": [BODY, GEL]}, "/inputs", "outside the skin first"),
        ({"layers": [GEL | {"name": "a"}, GEL | {"name": "b", "depth_mm": 2}]}, "/inputs", "decrease"),
    ],
)
def test_what_makes_no_sense_is_refused_at_once(
    service: Service, upload: str, inputs: dict[str, Any], pointer: str, words: str
) -> None:
    reply = service.http.post("/v1/processes/shells/execution", json={"inputs": {"skin": {"href": upload}, **inputs}})
    assert (reply.status_code, reply.json()["code"]) == (422, "inputs.invalid")
    found = {error["pointer"]: error["detail"] for error in reply.json()["errors"]}
    assert words in found[pointer]
