"""A client that knows the standard and not us: OWSLib's OGC API - Processes."""

import time

from owslib.ogcapi.processes import Processes

from core.mesh import Mesh
from tests.acceptance.service import Service
from tests.embedded import Embedded
from tests.solids import sphere

LIMIT_S = 120.0


def test_owslib_lists_executes_polls_and_fetches(server: Embedded, service: Service) -> None:
    ball: Mesh = sphere(100.0, 4)
    reference = service.upload(ball, "ball")
    client = Processes(f"{server.url}/v1")
    assert client.conformance()["conformsTo"]
    assert {process["id"] for process in client.processes()} >= {"validate", "shells"}
    description = client.process("validate")
    assert description["id"] == "validate"
    assert set(description["inputs"]) >= {"meshes"}

    status = client.execute("validate", {"meshes": {"href": f"{server.url}{reference}"}})
    job = status["jobID"]
    deadline = time.monotonic() + LIMIT_S
    while (status := client.monitor_execution(job))["status"] in ("accepted", "running"):
        assert time.monotonic() < deadline
        time.sleep(0.2)
    assert status["status"] == "successful"
    assert client.job(job)["jobID"] == job
    assert set(client.job_result(job)) >= {"report"}
