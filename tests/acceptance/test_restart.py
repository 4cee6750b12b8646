"""The whole server stopped, then killed, in mid-job and started again each time: the job finishes."""

import signal
from contextlib import closing
from pathlib import Path
from typing import Any

from subjects.body import body
from tests.acceptance.service import Service, unpack_shells
from tests.embedded import embedded


def is_under_way(status: dict[str, Any]) -> bool:
    return bool(status["status"] == "running" and status["progress"] >= 10)


def test_job_survives_the_stop_and_the_sigkill_of_the_whole_server(tmp_path: Path) -> None:
    # one job at a time, so that the second one waits
    with embedded(tmp_path / "data", {"INTEGUMENT_WORKER_CONCURRENCY": "1"}) as server:
        with closing(Service(server.url)) as first:
            skin = first.upload(body(0), "body")
            job = first.shells(skin)
            first.wait(job, is_under_way)
            family = server.family()
        assert server.stop(signal.SIGINT) == 0
        assert [process for process in family if process.is_running()] == []
        assert "did not stop in time" not in server.output.read_text()

        server.start()
        with closing(Service(server.url)) as second:
            assert second.wait(job, is_under_way)["attempt"] == 1  # handed back in good order: that costs no attempt
            waiting = second.execute("validate", {"meshes": {"href": skin}})
        for process in server.family():
            process.kill()
        server.kill()

        server.start()
        with closing(Service(server.url)) as third:
            ended = third.succeed(job)
            assert ended["attempt"] == 2
            assert ended["verdict"] == "simulation_ready"
            assert set(unpack_shells(third.result(job, "package"))) == {"skin", "fat", "average_body"}
            assert third.succeed(waiting)["verdict"] == "simulation_ready"
            assert third.http.get(f"/v1/jobs/{job}/events").text.count("event: done") == 1
