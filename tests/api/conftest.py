"""One live API for all tests that need no settings of their own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from store.settings import Settings
from tests.api.live import Live, serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer

QUEUE = "tests-api"


@pytest.fixture(scope="session")
def api(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Live]:
    """Serving, with a real broker and no worker: a job stays accepted until a test does something about it."""
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("api"),
        broker_url=shared_valkey.url,
        queue=QUEUE,
        event_poll_s=0.05,
        upload_limit_bytes=64 * 1024,
        port=0,
    )
    with serving(settings) as live:
        yield live


@pytest.fixture
def stl() -> bytes:
    """A tetrahedron of 100 mm."""
    return binary_stl()


@pytest.fixture(scope="session")
def mesh_href(api: Live) -> str:
    """A mesh the server holds."""
    return api.mesh_href(binary_stl())
