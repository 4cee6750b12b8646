"""Ears of one shell set into another over HTTP, from the skin to the proof that the result nests in it."""

import numpy as np

from core.geometry.exact_intersection import find_intersecting_faces
from tests.acceptance.service import Service, read_stl

EARS = [
    {"name": "right_ear", "box_mm": {"min": [-120, 670, 0], "max": [-62, 760, 80]}},
    {"name": "left_ear", "box_mm": {"min": [62, 670, 0], "max": [120, 760, 80]}},
]


def test_thin_ears_by_cut_and_paste(service: Service, skin: str) -> None:
    jobs = [service.shells(skin, layers=[{"name": "fat", "depth_mm": depth_mm}]) for depth_mm in (1.0, 0.3)]
    for job in jobs:
        service.succeed(job)
    base, donor = ({"href": f"/v1/jobs/{job}/results/fat"} for job in jobs)
    job = service.execute("graft", {"base": base, "donor": donor, "regions": EARS})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    made = read_stl(service.result(job, "mesh"))
    assert len(find_intersecting_faces(made.vertices, made.faces)) == 0
    assert [np.unique(made.faces).size - len(made.faces) // 2, len(made.faces) % 2] == [2, 0]  # a closed sphere
    together = {"skin": {"href": skin}, "fat": {"href": f"/v1/jobs/{job}/results/mesh"}}
    proof = service.execute("validate", {"meshes": together, "min_gap_mm": 0.05})
    assert service.succeed(proof)["verdict"] == "simulation_ready"
    assert service.report(proof)["nesting"] == {"skin": None, "fat": "skin"}


def test_a_region_beside_the_body_is_refused(service: Service, skin: str) -> None:
    beside = [{"name": "nowhere", "box_mm": {"min": [900, 0, 0], "max": [950, 50, 50]}}]
    job = service.execute("graft", {"base": {"href": skin}, "donor": {"href": skin}, "regions": beside})
    status = service.wait(job)
    assert status["status"] == "failed"
    assert (status["failure"]["code"], status["failure"]["class"]) == ("region.outside_mesh", "input")
    assert "496" in status["failure"]["message"]
