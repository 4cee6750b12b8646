"""One embedded server for all pages."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from subjects.body import body
from subjects.generated.pieces import moved
from subjects.generated.revolved import ball
from tests.docs.workshop import Workshop
from tests.embedded import embedded


@pytest.fixture(scope="session")
def docs_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with embedded(tmp_path_factory.mktemp("docs") / "data") as server:
        yield server.url


@pytest.fixture(scope="session")
def ball_workshop(docs_server: str, tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    """With a ball of 1,280 faces for a skin, where the body's head is: the boxes of the pages lie on it."""
    return Workshop.of(docs_server, moved(ball(95.0, 3), 0, 715, 40).rounded_to_float32(), tmp_path_factory.mktemp("ball"))


@pytest.fixture(scope="session")
def body_workshop(docs_server: str, tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    """With the real body, for blocks about ears and whole people."""
    return Workshop.of(docs_server, body(0), tmp_path_factory.mktemp("body"), is_body=True)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "page").mkdir()
    return tmp_path / "page"
