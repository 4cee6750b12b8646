"""`ears` over HTTP: both ears of the real body found, canals of the user cut in, thin layers there."""

from typing import Any

import numpy as np
import pytest

from core.ears.canal import make_canal
from core.geometry.distance import closest_points
from core.mesh import Mesh
from tests.acceptance.service import Service, unpack_shells
from tests.acceptance.test_main_job import count_intersections

# from concha to eardrum, as a segmentation would give it
CANALS = {side: make_canal((sign * 68.1, 706.7, 55.0), (-sign, 0, 0), (0, 1, 0)) for side, sign in (("left", 1), ("right", -1))}


@pytest.fixture(scope="module")
def done(service: Service, skin: str) -> dict[str, Any]:
    canals = [{"href": service.upload(canal, f"{side}_canal")} for side, canal in CANALS.items()]
    job = service.execute("ears", {"skin": {"href": skin}, "canals": canals})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    return {"job": job, "report": service.report(job), "shells": unpack_shells(service.result(job, "package"))}


def test_ears_are_found_and_canals_cut(done: dict[str, Any]) -> None:
    shells: dict[str, Mesh] = done["shells"]
    assert count_intersections(shells) == 0
    regions = {region["name"]: region["box_mm"] for region in done["report"]["parameters"]["regions"]}
    assert list(regions) == ["left_ear", "right_ear", "left_canal", "right_canal"]
    skin, fat = shells["skin"], shells["fat"]
    for side, canal in CANALS.items():
        box = regions[f"{side}_canal"]
        wall = skin.vertices[((skin.vertices >= box["min"]) & (skin.vertices <= box["max"])).all(axis=1)]
        assert len(wall) > 300
        assert np.median(closest_points(canal.vertices, canal.faces, wall)[0]) < 0.01
        inside = fat.vertices[((fat.vertices >= box["min"]) & (fat.vertices <= box["max"])).all(axis=1)]
        assert np.median(closest_points(skin.vertices, skin.faces, inside)[0]) == pytest.approx(0.3, rel=0.05)


def test_the_description_tells_how_to_ask(service: Service) -> None:
    described = service.http.get("/v1/processes/ears").json()
    assert "auto" in str(described["inputs"]["ears"]["schema"])
    assert {"canals", "generate_canals", "ear_depths_mm", "blend_mm"} <= set(described["inputs"])


def test_a_surface_without_ears_is_refused_by_name(service: Service) -> None:
    job = service.execute("ears", {"skin": {"href": service.upload(CANALS["left"], "no_body")}})
    ended = service.wait(job)
    assert ended["failure"]["code"] == "ears.not_found"
    assert ended["failure"]["class"] == "input"
