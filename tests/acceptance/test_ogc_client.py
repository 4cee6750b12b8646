"""A client that knows the standard and not us: OWSLib's OGC API - Processes."""

import time

import requests
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

    status = client.execute("validate", {"meshes": {"href": f"{server.url}{reference}"}}, async_=True)
    job = status["jobID"]
    deadline = time.monotonic() + LIMIT_S
    while status["status"] in ("accepted", "running"):
        assert time.monotonic() < deadline
        time.sleep(0.2)
        status = client._request(path=f"jobs/{job}")  # it has no name of its own for polling
    assert status["status"] == "successful"
    results = client._request(path=f"jobs/{job}/results")
    assert set(results) == {"report", "report_html"}
    report = requests.get(results["report"]["href"], timeout=30).json()
    assert report["meshes"]["ball"]["faces"] == len(ball.faces)
