"""A browser and a server for the tests of one file."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from store.settings import Settings
from tests.api.live import Live, serving
from tests.valkey import ValkeyServer
from tests.web.browser import chromium


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Debian's Chromium, without a window."""
    with chromium() as browser:
        yield browser


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Live]:
    """No worker: what is asked for waits."""
    settings = Settings(data_dir=tmp_path_factory.mktemp("page"), broker_url=shared_valkey.url, queue="tests-page", port=0)
    with serving(settings) as live:
        yield live
