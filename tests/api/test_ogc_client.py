"""A client we did not write: OWSLib. (The whole way, with a worker, is in tests/acceptance.)"""

from __future__ import annotations

import pytest
import requests
from owslib.ogcapi.processes import Processes

from core.schema.processes import PROCESSES
from tests.api.live import Live


@pytest.fixture
def ogc(api: Live) -> Processes:
    """As its users make it."""
    return Processes(f"{api.url}/v1")


def test_it_finds_its_way(ogc: Processes) -> None:
    assert "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/core" in ogc.conformance()["conformsTo"]
    assert ogc.api()["openapi"] == "3.0.3"
    assert [process["id"] for process in ogc.processes()] == list(PROCESSES)
    assert ogc.process("validate")["inputs"]["meshes"]["minOccurs"] == 1


@pytest.mark.parametrize("asynchronous", [True, False])
def test_it_executes_and_follows(api: Live, ogc: Processes, mesh_href: str, asynchronous: bool) -> None:
    told = ogc.execute("validate", {"meshes": {"href": mesh_href}}, async_=asynchronous)
    assert ogc.response_headers["Location"] == f"/v1/jobs/{told['jobID']}"
    job = api.services.jobs.claim(told["jobID"], 1, "tests", 60.0)
    assert job is not None
    output = api.stored(b"{}", "application/json", "report.json")
    api.services.jobs.finish(
        job.id, job.lease_token, verdict="not_ready", summary="1 error", outputs={"report": output}, timings_s={}
    )
    (monitor,) = (link["href"] for link in told["links"] if link["rel"] == "self")
    status = requests.get(monitor, timeout=10).json()
    assert status["status"] == "successful"
    (results,) = (link["href"] for link in status["links"] if link["rel"].endswith("/results"))
    assert requests.get(requests.get(results, timeout=10).json()["report"]["href"], timeout=10).json() == {}


def test_it_hears_what_is_wrong(ogc: Processes) -> None:
    with pytest.raises(RuntimeError, match=r"inputs\.invalid.*/inputs/meshes"):
        ogc.execute("validate", {"mesh": 1})
