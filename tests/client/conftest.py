from __future__ import annotations

from collections.abc import Iterator

import pytest
from integument import Client

from tests.client.faulty_server import State, faulty_server


@pytest.fixture
def lab() -> Iterator[tuple[str, State]]:
    with faulty_server() as (url, state):
        yield url, state


@pytest.fixture
def state(lab: tuple[str, State]) -> State:
    return lab[1]


@pytest.fixture
def client(lab: tuple[str, State]) -> Iterator[Client]:
    with Client(lab[0], retries=3, first_pause_s=0.001, timeout_s=5) as client:
        yield client
