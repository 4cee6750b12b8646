"""Parts that touch set apart over HTTP: upload, job, file, and the next process on the result."""

from core.geometry.exact_intersection import find_intersecting_faces
from subjects.touching import balls_grown_together, closed_ring, crossing_ring
from tests.acceptance.service import Service, read_stl

REGION = {"name": "contact", "box_mm": {"min": [20, -30, -15], "max": [60, 30, 15]}}


def test_a_ring_is_opened_and_its_report_says_how(service: Service) -> None:
    ring = closed_ring(4.0)
    skin = service.upload(ring, "ring")
    job = service.execute("detach", {"skin": {"href": skin}, "regions": [REGION], "gap_mm": 0.5})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    made = read_stl(service.result(job, "skin"))
    assert len(find_intersecting_faces(made.vertices, made.faces)) == 0
    assert len(made.vertices) - len(made.faces) // 2 == 2  # the ring's handle is gone
    (change,) = service.report(job)["changes"]
    assert change["gap_mm"] >= 0.5
    proof = service.execute("validate", {"meshes": {"skin": {"href": f"/v1/jobs/{job}/results/skin"}}})
    assert service.succeed(proof)["verdict"] == "simulation_ready"


def test_ends_that_cross_each_other_are_united_first_and_it_is_said(service: Service) -> None:
    skin = service.upload(crossing_ring(6.0), "ring")
    job = service.execute("detach", {"skin": {"href": skin}, "regions": [REGION]})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    made = read_stl(service.result(job, "skin"))
    assert len(find_intersecting_faces(made.vertices, made.faces)) == 0
    assert "detach.united" in [finding["code"] for finding in service.report(job)["findings"]]


def test_a_box_that_holds_too_much_is_refused_by_name(service: Service) -> None:
    skin = service.upload(balls_grown_together(30.0, 50.0), "balls")
    everything = {"name": "everything", "box_mm": {"min": [-40, -40, -40], "max": [90, 40, 40]}}
    job = service.execute("detach", {"skin": {"href": skin}, "regions": [everything]})
    status = service.wait(job)
    assert status["status"] == "failed"
    assert (status["failure"]["code"], status["failure"]["class"]) == ("detach.region_cuts_too_much", "input")
    assert "2 pieces" in status["failure"]["message"]
