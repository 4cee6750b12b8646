"""The ears of an upload, as the process would find them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from store.settings import Settings
from subjects.body import body
from tests.acceptance.service import binary_stl
from tests.api.live import Live, problem_of, serving
from tests.valkey import ValkeyServer


@pytest.fixture(scope="module")
def roomy(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Live]:
    """Takes the real body, which is larger than what the other tests send."""
    settings = Settings(data_dir=tmp_path_factory.mktemp("ears"), broker_url=shared_valkey.url, queue="tests-ears", port=0)
    with serving(settings) as live:
        yield live


def test_both_ears_of_the_body_are_found_where_they_are(roomy: Live) -> None:
    mesh = roomy.mesh_href(binary_stl(body(0)))
    found = roomy.client.get(f"{mesh}/ears")
    assert found.status_code == 200, found.text
    boxes = {ear["name"]: ear["box_mm"] for ear in found.json()["ears"]}
    assert set(boxes) == {"left_ear", "right_ear"}
    # y is up, the left ear on the side of positive x; both at the height of the head, about 60 mm tall
    assert boxes["left_ear"]["min"][0] > 50 > -50 > boxes["right_ear"]["max"][0]
    for box in boxes.values():
        assert 600 < box["min"][1] < box["max"][1] < 800
        assert 40 < box["max"][1] - box["min"][1] < 100
    # they fit into a job as they are
    job = roomy.execute("ears", {"skin": {"href": mesh}, "ears": found.json()["ears"]})
    assert job.status_code == 201, job.text


def test_what_has_no_ears_is_said_so(api: Live, mesh_href: str) -> None:
    problem = problem_of(api.client.get(f"{mesh_href}/ears"), 422, "ears.not_found")
    assert not problem["retryable"]
