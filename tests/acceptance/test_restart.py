"""`integument serve` killed as a whole in mid-job and started again: the job finishes."""

from pathlib import Path

from subjects.body import body
from tests.acceptance.service import Service, unpack_shells
from tests.embedded import embedded


def test_job_survives_the_sigkill_of_the_whole_server(tmp_path: Path) -> None:
    with embedded(tmp_path / "data") as server:
        before = Service(server.url)
        job = before.shells(before.upload(body(0), "body"))
        waiting = before.execute("validate", {"meshes": {"href": before.upload(body(0), "body")}})
        before.wait(job, lambda status: status["status"] == "running" and status["progress"] >= 10)
        for process in server.family():
            process.kill()  # all of it, in any order
        server.kill()

        server.start()
        after = Service(server.url)
        ended = after.succeed(job)
        assert ended["attempt"] == 2
        assert ended["verdict"] == "simulation_ready"
        assert set(unpack_shells(after.result(job, "package"))) == {"skin", "fat", "average_body"}
        assert after.succeed(waiting)["verdict"] == "simulation_ready"
        events = after.http.get(f"/v1/jobs/{job}/events").text
        assert events.count("event: done") == 1
        before.http.close()
        after.http.close()
