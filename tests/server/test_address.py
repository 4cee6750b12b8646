"""Where the server may listen."""

import socket

import pytest

from core.errors import StateError
from server.address import base_url, choose_port


def test_port_zero_is_a_free_port() -> None:
    port = choose_port("127.0.0.1", 0)
    with socket.create_server(("127.0.0.1", port)):
        assert port > 0


def test_port_in_use_is_named() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(StateError) as refusal:
            choose_port("127.0.0.1", port)
    assert refusal.value.code == "server.port_in_use"
    assert refusal.value.facts == {"port": port}


def test_urls_of_both_families() -> None:
    assert base_url("127.0.0.1", 8000) == "http://127.0.0.1:8000"
    assert base_url("::1", 8000) == "http://[::1]:8000"
    assert base_url("0.0.0.0", 8000) == "http://127.0.0.1:8000"
    assert base_url("::", 8000) == "http://[::1]:8000"
