"""Names and labels of jobs, and lists searched by them, over HTTP."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from tests.api.live import Live, problem_of


def executed(api: Live, mesh_href: str, **words: Any) -> httpx.Response:
    body = {"inputs": {"meshes": {"href": mesh_href}}, **words}
    return api.client.post("/v1/processes/validate/execution", json=body)


def ids(api: Live, **asked: Any) -> list[str]:
    response = api.client.get("/v1/jobs", params=asked)
    assert response.status_code == 200, response.text
    return [job["jobID"] for job in response.json()["jobs"]]


def test_a_job_is_named_and_labelled_when_it_is_sent(api: Live, mesh_href: str) -> None:
    told = executed(api, mesh_href, name="  Ella, <b>first</b> try ", labels=["zebra", "site=Boston", "zebra"]).json()
    assert (told["name"], told["labels"]) == ("Ella, <b>first</b> try", ["zebra", "site=Boston"])
    other = executed(api, mesh_href).json()
    assert "name" not in other
    assert other["labels"] == []
    assert ids(api, label="zebra") == ids(api, label=["zebra", "site=Boston"]) == ids(api, q="ELLA first") == [told["jobID"]]
    assert ids(api, label="zebra", status="failed") == ids(api, label="Zebra") == ids(api, q="ella second") == []


def test_a_page_of_a_search_leads_to_the_next(api: Live, mesh_href: str) -> None:
    made = [executed(api, mesh_href, name="päge", labels=["a b&c"]).json()["jobID"] for _ in range(3)]
    first = api.client.get("/v1/jobs", params={"label": "a b&c", "q": "PÄGE", "limit": 2})
    following = next(link["href"] for link in first.json()["links"] if link["rel"] == "next")
    told = [job["jobID"] for page in (first, httpx.get(following)) for job in page.json()["jobs"]]
    assert told == made[::-1]


def test_labels_change_later_and_what_is_left_out_stays(api: Live, mesh_href: str) -> None:
    job = executed(api, mesh_href, name="one", labels=["x1", "x2"]).json()["jobID"]
    path = f"/v1/jobs/{job}"
    assert api.client.patch(path, json={"labels": ["x3"]}).json()["name"] == "one"
    told = api.client.patch(path, json={"name": None}).json()
    assert ("name" in told, told["labels"]) == (False, ["x3"])
    assert api.client.get(path).json()["labels"] == ["x3"]
    assert (ids(api, label="x1"), ids(api, label="x3")) == ([], [job])
    assert api.client.patch(path, json={}).json()["labels"] == ["x3"]


@pytest.mark.parametrize(
    ("words", "pointer"),
    [
        ({"labels": ["a" * 65]}, "/labels/0"),
        ({"labels": ["fine", "line\nbreak"]}, "/labels/1"),
        ({"labels": [""]}, "/labels/0"),
        ({"labels": [f"l{number}" for number in range(21)]}, "/labels"),
        ({"labels": "pilot"}, "/labels"),
        ({"name": "n" * 201}, "/name"),
        ({"name": "\u202eevil"}, "/name"),
    ],
)
def test_words_that_cannot_be_shown_or_are_too_many_are_refused(
    api: Live, mesh_href: str, words: dict[str, Any], pointer: str
) -> None:
    told = problem_of(executed(api, mesh_href, **words), 422, "request.invalid")
    assert told["errors"][0]["pointer"] == pointer
    job = api.accepted()
    problem_of(api.client.patch(f"/v1/jobs/{job.id}", json=words), 422, "request.invalid")


def test_no_byte_of_a_search_harms(api: Live) -> None:
    for name in ("q", "label", "cohort"):
        told = api.client.get("/v1/jobs", params={name: "a\x00%"})
        assert told.status_code == (200 if name == "q" else 422)
    assert api.client.get("/v1/meshes", params={"q": "a\x00 \x00"}).status_code == 200


def test_the_same_key_with_other_labels_is_another_request(api: Live, mesh_href: str) -> None:
    headers = {"Idempotency-Key": "labels-1"}
    body = {"inputs": {"meshes": {"href": mesh_href}}}
    path = "/v1/processes/validate/execution"
    first = api.client.post(path, json=body, headers=headers)
    assert api.client.post(path, json={**body, "labels": [], "name": None}, headers=headers).json() == first.json()
    problem_of(api.client.post(path, json={**body, "labels": ["l"]}, headers=headers), 422, "idempotency.mismatch")


def test_meshes_are_found_beyond_the_first_page(api: Live, stl: bytes) -> None:
    sent = api.upload(stl, "giraffe.stl").json()["id"]
    api.upload(stl, "skin.stl")
    page = api.client.get("/v1/meshes", params={"q": "GIRAFFE", "limit": 1}).json()
    assert [mesh["id"] for mesh in page["meshes"]] == [sent]
    assert "next" not in page
    problem_of(api.client.get("/v1/meshes", params={"q": "x" * 201}), 422, "request.invalid")
