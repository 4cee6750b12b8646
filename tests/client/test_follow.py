import pytest
from integument import Client, JobDismissedError, JobFailedError, ProblemError, ServerUnreachableError
from integument.errors import WaitTimeoutError

from tests.client.faulty_server import JOB_ID, Drop, Refuse, State

PATH = f"/v1/jobs/{JOB_ID}/events"
EVENTS = [
    (1, "status", {"status": "accepted"}),
    (2, "progress", {"progress": 10, "phase": "fat", "message": "one"}),
    (3, "log", {"message": "two"}),
    (4, "progress", {"progress": 90, "phase": "fat", "message": "three"}),
    (5, "done", {"status": "successful", "attempt": 1}),
]


def test_every_event_comes_once_and_in_order_although_each_connection_breaks(client: Client, state: State) -> None:
    state.add_job("successful", verdict="simulation_ready")
    state.events = EVENTS
    state.stops.extend([2, 3, 4])

    assert [event.id for event in client.events(JOB_ID)] == ["1", "2", "3", "4", "5"]

    asked = [seen.headers.get("last-event-id") for seen in state.requests("GET", PATH)]
    assert asked == [None, "2", "3", "4"]


def test_the_first_connection_starts_behind_after(client: Client, state: State) -> None:
    state.add_job("successful")
    state.events = EVENTS
    assert [event.id for event in client.events(JOB_ID, after="3")] == ["4", "5"]


def test_refused_and_dropped_connections_are_replaced_while_the_job_runs(client: Client, state: State) -> None:
    state.add_job("running")
    state.events = EVENTS
    state.faults[f"GET {PATH}"].extend([Refuse(503), Drop(), Drop(), Drop(), Drop()])
    events = []
    for event in client.events(JOB_ID):
        events.append(event.id)
        state.jobs[JOB_ID]["status"] = "successful"
    assert events == ["1", "2", "3", "4", "5"]


def test_events_that_never_come_through_do_not_hold_up_a_finished_job(client: Client, state: State) -> None:
    state.add_job("successful", verdict="simulation_ready")
    state.faults[f"GET {PATH}"].extend([Drop()] * 10)
    assert client.wait(JOB_ID).ready


def test_a_done_of_an_earlier_attempt_is_not_the_end(client: Client, state: State) -> None:
    state.add_job("successful", attempt=2)
    state.events = [
        (1, "done", {"status": "failed", "attempt": 1}),
        (2, "status", {"status": "accepted", "attempt": 2}),
        (3, "done", {"status": "successful", "attempt": 2}),
    ]
    assert [event.id for event in client.events(JOB_ID)] == ["1", "2", "3"]


def test_a_server_that_is_gone_for_a_while_is_waited_for(client: Client, state: State) -> None:
    state.add_job("successful")
    state.events = EVENTS
    state.stops.append(2)
    state.faults[f"GET {PATH}"].append(Refuse(503))
    state.faults[f"GET /v1/jobs/{JOB_ID}"].extend([Drop()] * 9)  # more than the client's retries
    assert [event.id for event in client.events(JOB_ID)] == ["1", "2", "3", "4", "5"]


def test_the_watch_gives_up_when_the_server_is_gone(client: Client, state: State, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("integument.follow.LOST_AFTER_S", 0.0)
    state.add_job("running")
    state.faults[f"GET {PATH}"].append(Drop())
    state.faults[f"GET /v1/jobs/{JOB_ID}"].extend([Drop()] * 4)
    with pytest.raises(ServerUnreachableError, match="no answer from"):
        list(client.events(JOB_ID))


def test_events_of_an_unknown_job_are_a_problem(client: Client) -> None:
    with pytest.raises(ProblemError) as caught:
        list(client.events(JOB_ID))
    assert caught.value.code == "job.not_found"


def test_without_follow_the_past_is_all(client: Client, state: State) -> None:
    state.add_job("running")
    state.events = EVENTS[:3]
    state.endless_events = True
    assert [event.id for event in client.events(JOB_ID, follow=False)] == ["1", "2", "3"]


def test_wait_returns_the_job_and_tells_of_every_event(client: Client, state: State) -> None:
    state.add_job("successful", verdict="not_ready")
    state.events = EVENTS
    told: list[tuple[str, str, float | None]] = []
    job = client.wait(JOB_ID, lambda event: told.append((event.type, event.message, event.progress)))
    assert (job.status, job.ready) == ("successful", False)
    assert told[1] == ("progress", "one", 10.0)
    assert len(told) == 5


def test_wait_raises_what_became_of_the_job(client: Client, state: State) -> None:
    failure = {"code": "skin.not_closed", "class": "input", "message": "3 edges are open", "retryable": False}
    state.add_job("failed", failure=failure)
    state.events = EVENTS
    with pytest.raises(JobFailedError, match=r"skin.not_closed: 3 edges are open") as caught:
        client.wait(JOB_ID)
    assert caught.value.job.failure is not None
    assert caught.value.job.failure.fault == "input"
    state.jobs[JOB_ID]["status"] = "dismissed"
    with pytest.raises(JobDismissedError):
        client.wait(JOB_ID)


def test_wait_has_a_limit(client: Client, state: State) -> None:
    state.add_job("running")
    state.events = EVENTS[:2]
    with pytest.raises(WaitTimeoutError, match="it goes on"):
        client.wait(JOB_ID, timeout_s=0)
