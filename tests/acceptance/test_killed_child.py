"""SIGKILL in mid-job, to the geometry child and to the worker: the job is tried once more, and no other one is harmed."""

import time

import psutil

from tests.acceptance.service import Service
from tests.embedded import Embedded
from tests.solids import sphere

LIMIT_S = 120.0


def kill_child(server: Embedded, service: Service, job: str, attempt: int) -> None:
    """Wait until this attempt of the job works, and kill what does the work."""
    service.wait(job, lambda status: status["status"] == "running" and status["attempt"] == attempt and status["progress"] >= 5)
    server.child_at_work(job).kill()


def test_killed_child_costs_one_attempt_and_no_other_job(server: Embedded, service: Service, skin: str) -> None:
    worker = server.part("worker")
    deadly = {"layers": [{"name": "fat", "depth_mm": 1.25}]}  # a request of its own: it will be parked
    job = service.shells(skin, **deadly)
    kill_child(server, service, job, attempt=1)
    kill_child(server, service, job, attempt=2)
    ended = service.wait(job)
    assert ended["status"] == "failed"
    assert ended["attempt"] == 2
    assert ended["failure"]["code"] == "child.crashed"
    assert "SIGKILL" in ended["failure"]["message"]
    problem = service.http.get(f"/v1/jobs/{job}/results")
    assert problem.status_code == 500
    assert problem.json()["code"] == "child.crashed"

    first, second = service.http.get(f"/v1/jobs/{job}/attempts").json()["attempts"]
    assert (first["attempt"], second["attempt"]) == (1, 2)
    assert first["signal"] == second["signal"] == "SIGKILL"
    assert second["worker"].endswith(f":{worker.pid}")
    again = service.http.post("/v1/processes/shells/execution", json={"inputs": {"skin": {"href": skin}, **deadly}})
    assert (again.status_code, again.json()["code"]) == (409, "job.parked")

    following = service.execute("validate", {"meshes": {"href": service.upload(sphere(100.0, 3), "ball")}})
    assert service.succeed(following)["verdict"] == "simulation_ready"
    assert server.part("worker").pid == worker.pid  # and nobody had to be started again


def test_killed_worker_costs_one_attempt_and_no_waiting_for_leases(server: Embedded, service: Service, skin: str) -> None:
    worker = server.part("worker")
    job = service.shells(skin)
    service.wait(job, lambda status: status["status"] == "running" and status["progress"] >= 5)
    family = [worker, *worker.children(recursive=True)]
    assert len(family) >= 3  # worker, nursery, child
    worker.kill()
    _, alive = psutil.wait_procs(family, timeout=5)
    assert alive == []
    started = time.monotonic()
    assert service.wait(job, lambda status: status["status"] == "running")["attempt"] == 2
    assert time.monotonic() - started < 25  # a lease alone is 30 s
    assert service.http.delete(f"/v1/jobs/{job}").json()["status"] == "dismissed"


def test_dismissed_job_is_gone_within_two_seconds(server: Embedded, service: Service, skin: str) -> None:
    job = service.shells(skin)
    service.wait(job, lambda status: status["status"] == "running" and status["progress"] >= 5)
    child = server.child_at_work(job)
    started = time.monotonic()
    assert service.http.delete(f"/v1/jobs/{job}").json()["status"] == "dismissed"
    _, alive = psutil.wait_procs([child], timeout=2)
    assert alive == []
    assert time.monotonic() - started < 2.5
    assert service.status(job)["status"] == "dismissed"
