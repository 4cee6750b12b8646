"""Jobs from the doorbell to the job table, through one real worker that every test must leave alive."""

from __future__ import annotations

import json
import os
import signal
import time
from pathlib import Path
from typing import Any

import pytest
import redis

from store.job import Job, JobStatus, MeshInput
from store.workspace import DEFAULT_WORKSPACE
from tests.sandbox.ending import wait_for_end
from tests.worker.conftest import Service
from worker.progress import MAX_LOG_LINES


@pytest.fixture(autouse=True)
def _the_worker_stays(running: Service) -> Any:
    """Whatever a test does to its job, the same worker does that of the next test; the last test does twenty."""
    yield
    assert [worker.poll() for worker in running.workers] == [None]


def test_a_job_ends_with_outputs_timings_and_events(running: Service) -> None:
    blob = running.blobs.put_bytes(b"solid")
    mesh = MeshInput("/v1/meshes/1", "skin", blob.sha256, "model/stl", "skin.stl")
    job = running.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "write"}, mesh_inputs=[mesh])
    assert running.doorbell.ring(job.id, 1)
    done = running.wait(job)
    assert (done.status, done.verdict, done.summary, done.progress) == ("successful", "simulation_ready", "all is well", 100.0)
    assert (done.attempt, done.failure, done.lease_owner) == (1, None, None)
    report = done.outputs["report"]
    assert running.blobs.path(report.sha256).read_text() == "validate solid"
    assert (report.size, report.media_type, report.file_name) == (14, "application/json", "report.json")
    # the libraries may still be loading when the first job comes
    assert set(done.timings_s) - {"load the libraries"} == {"start", "begin", "work", "store"}
    assert done.peak_memory_bytes is not None
    assert done.peak_memory_bytes > 1 << 20
    types = [event.type for event in running.events.after(DEFAULT_WORKSPACE, job.id)]
    assert types[:2] == ["status", "status"]  # accepted, running
    assert types[-1] == "done"
    assert "log" in types


def test_an_input_error_fails_at_once_and_leaves_its_report(running: Service) -> None:
    failed = running.wait(running.submit("refuse"))
    assert failed.status is JobStatus.FAILED
    assert failed.attempt == 1
    assert failed.failure is not None
    assert failed.failure.describe() == {
        "code": "skin.not_closed",
        "class": "input",
        "message": "the skin has 2 holes",
        "retryable": False,
        "facts": {"holes": 2},
        "findings": [{"code": "mesh.open", "severity": "error", "message": "2 holes", "count": 2, "places": []}],
    }
    assert running.blobs.path(failed.outputs["report"].sha256).read_text() == "refused"


@pytest.mark.parametrize(("end", "code"), [("segfault", "child.crashed"), ("loop_in_native_code", "limit.wall_time")])
def test_what_a_child_said_would_stay_is_kept_if_it_is_ended(running: Service, end: str, code: str) -> None:
    failed = running.wait(running.submit("leave", end=end, max_attempts=1))
    assert failed.failure is not None
    assert failed.failure.code == code
    assert running.blobs.path(failed.outputs["record"].sha256).read_text() == "half way"


@pytest.mark.parametrize(
    ("act", "code", "attempts"),
    [
        ("segfault", "child.crashed", 2),
        ("leave_at_once", "child.crashed", 2),
        ("fill_bytearray", "limit.memory", 1),
        ("fill_with_family", "child.raised", 1),  # it may start nobody
        ("loop_in_native_code", "limit.wall_time", 1),
        ("write_large_file", "limit.file_size", 1),
        ("print_without_end", "limit.file_size", 1),
        ("leave_by_system_exit", "child.raised", 1),
        ("raise_key_error", "child.raised", 1),
        ("send_one_endless_line", "child.protocol_broken", 1),
        ("return_much", "child.protocol_broken", 1),
    ],
)
def test_a_job_that_cannot_end_well_fails_with_a_reason(running: Service, act: str, code: str, attempts: int) -> None:
    failed = running.wait(running.submit(act, processes=3, mib_each=170, bytes=8 << 20))
    assert failed.status is JobStatus.FAILED
    assert failed.failure is not None
    assert (failed.failure.code, failed.attempt) == (code, attempts)


def test_a_crash_is_tried_once_more(running: Service) -> None:
    done = running.wait(running.submit("crash_once"))
    assert (done.status, done.attempt) == (JobStatus.SUCCESSFUL, 2)


def test_a_killed_child_is_replaced_once_then_named(running: Service) -> None:
    job = running.submit("sleep", seconds=1)
    os.kill(running.wait_for_child(job), signal.SIGKILL)
    done = running.wait(job)
    assert (done.status, done.attempt) == (JobStatus.SUCCESSFUL, 2)

    job = running.submit("sleep", seconds=60, max_attempts=1)
    os.kill(running.wait_for_child(job), signal.SIGKILL)
    failed = running.wait(job)
    assert failed.failure is not None
    assert (failed.failure.code, failed.failure.facts, failed.failure.retryable) == ("child.crashed", {"signal": "SIGKILL"}, True)


def test_a_killed_nursery_costs_one_attempt(running: Service) -> None:
    job = running.submit("sleep", seconds=1)
    child = running.wait_for_child(job)
    nursery = int(Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()[1])
    os.kill(nursery, signal.SIGKILL)
    assert wait_for_end([child]) == []
    done = running.wait(job)
    assert (done.status, done.attempt) == (JobStatus.SUCCESSFUL, 2)


@pytest.mark.parametrize("act", ["sleep", "loop_in_native_code", "send_without_end"])
def test_a_dismissed_job_is_dead_within_two_seconds(running: Service, act: str) -> None:
    job = running.submit(act, seconds=60, wait=True)
    child = running.wait_for_child(job)
    asked = time.monotonic()
    running.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    ended = running.wait(job)
    assert ended.status is JobStatus.DISMISSED
    assert wait_for_end([child], 0.0) == []
    assert time.monotonic() - asked < 2.0


def test_a_job_dismissed_while_it_waits_never_starts(running: Service) -> None:
    job = running.submit(ring=False)
    running.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    running.doorbell.ring(job.id, 1)
    time.sleep(0.3)
    assert running.jobs.get(DEFAULT_WORKSPACE, job.id).started_at is None


OUTPUT = {"name": "report", "path": "out/report.json", "media_type": "application/json", "file_name": "report.json"}


@pytest.mark.parametrize(
    "inputs",
    [
        {"outputs": [OUTPUT]},  # there is no such file
        {"outputs": [OUTPUT | {"path": "/etc/hostname"}]},
        {"outputs": [OUTPUT | {"path": "../../../integument.sqlite3"}]},
        {"outputs": [OUTPUT | {"path": "out"}]},
        {"outputs": [OUTPUT | {"path": "out/\0"}]},
        {"outputs": [OUTPUT | {"path": "child.log", "name": "re/port"}]},
        {"outputs": [OUTPUT | {"path": "child.log", "file_name": "../x"}]},
        {"outputs": [OUTPUT | {"path": "child.log", "media_type": "text/html\r\nSet-Cookie: a=b"}]},
        {"outputs": [OUTPUT | {"path": "child.log"}] * 2},
        {"outputs": [], "extra": {"verdict": "perfect"}},
        {"outputs": 3},
    ],
)
def test_a_child_cannot_hand_over_what_is_not_its_own(running: Service, inputs: dict[str, Any]) -> None:
    failed = running.wait(running.submit("lie", **inputs))
    assert failed.failure is not None
    assert failed.failure.code == "child.protocol_broken"
    assert failed.outputs == {}


def test_a_link_is_no_output(running: Service) -> None:
    failed = running.wait(running.submit("link", to="/etc/hostname"))
    assert failed.failure is not None
    # where the kernel can lock children in, it refuses the link itself
    assert failed.failure.code in ("child.raised", "child.protocol_broken")


def test_a_flood_of_log_lines_is_cut(running: Service) -> None:
    job = running.submit("talk", lines=MAX_LOG_LINES + 500)
    assert running.wait(job).status is JobStatus.SUCCESSFUL
    lines = [
        event.data["message"] for event in running.events.after(DEFAULT_WORKSPACE, job.id, limit=10_000) if event.type == "log"
    ]
    assert len(lines) == MAX_LOG_LINES
    assert lines[1:3] == ["line 0", "line 1"]
    assert lines[-1] == f"the log ends here: {MAX_LOG_LINES} lines"


def test_repeated_and_stale_messages_are_harmless(running: Service) -> None:
    job = running.submit("sleep", seconds=0.3, ring=False)
    for attempt in (1, 1, 1, 2, 0):
        running.doorbell.ring(job.id, attempt)
    running.doorbell.ring("no-such-job", 1)
    done = running.wait(job)
    assert (done.status, done.attempt, done.lease_token) == (JobStatus.SUCCESSFUL, 1, 1)
    running.doorbell.ring(job.id, 1)  # after its end
    time.sleep(0.2)
    assert running.jobs.get(DEFAULT_WORKSPACE, job.id) == done


def _envelope(running: Service, job: Job) -> dict[str, Any]:
    """The message a ring leaves in Valkey, taken back out; the queue has a name nobody listens to."""
    from store.doorbell import Doorbell

    doorbell = Doorbell(running.settings.broker_url, "nobody")
    assert doorbell.ring(job.id, job.attempt)
    doorbell.close()
    with redis.Redis(unix_socket_path=running.settings.broker_url.removeprefix("redis+socket://")) as valkey:
        envelope: dict[str, Any] = json.loads(valkey.rpop("nobody"))  # type: ignore[arg-type]
    return envelope


def test_no_message_kills_the_worker(running: Service) -> None:
    job = running.submit(ring=False)
    good = _envelope(running, job)
    wrong = [
        b"\xff\xfe no json",
        b"",
        b"3",
        b"[]",
        b"{}",
        json.dumps(good | {"properties": {}}).encode(),
        json.dumps(good | {"properties": None}).encode(),
        json.dumps(good | {"body": "%%%"}).encode(),
        json.dumps(good | {"body": None}).encode(),
        json.dumps(good | {"headers": {}}).encode(),
        json.dumps(good | {"headers": None}).encode(),
        json.dumps(good | {"headers": good["headers"] | {"task": "os.system"}}).encode(),
        json.dumps(good | {"headers": good["headers"] | {"eta": "yesterday"}}).encode(),
        json.dumps(good | {"headers": good["headers"] | {"expires": []}}).encode(),
        json.dumps(good | {"content-type": "application/x-python-serialize"}).encode(),
        json.dumps(good | {"content-type": "application/x-nonsense"}).encode(),
        json.dumps(good | {"content-encoding": "rot13"}).encode(),
    ]
    with redis.Redis(unix_socket_path=running.settings.broker_url.removeprefix("redis+socket://")) as valkey:
        for message in wrong:
            valkey.lpush(running.settings.queue, message)
        valkey.lpush(running.settings.queue, json.dumps(good))
    assert running.wait(job).status is JobStatus.SUCCESSFUL


@pytest.mark.parametrize(
    "arguments", [{}, {"job_id": 3, "attempt": []}, {"job_id": {"a": 1}, "attempt": 1}, {"job_id": "x", "attempt": 10**30}]
)
def test_no_argument_kills_the_worker(running: Service, arguments: dict[str, Any]) -> None:
    running.doorbell._app.send_task("jobs.run", kwargs=arguments, queue=running.settings.queue, ignore_result=True)
    assert running.wait(running.submit()).status is JobStatus.SUCCESSFUL


def test_one_bell_is_enough_for_all_that_wait(running: Service) -> None:
    """The worker of these tests looks without a bell once a minute only, yet whenever a job has ended."""
    jobs = [running.submit(ring=False) for _ in range(19)]
    jobs.append(running.submit())
    assert {running.wait(job).status for job in jobs} == {JobStatus.SUCCESSFUL}
