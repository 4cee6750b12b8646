"""Where the server may listen."""

import socket

import pytest

from core.errors import InputError, StateError
from server.address import base_url, choose_port, require_loopback


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "::1", "localhost"])
def test_loopback_is_allowed(host: str) -> None:
    require_loopback(host)


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1"])
def test_every_other_address_is_refused(host: str) -> None:
    with pytest.raises(InputError) as refusal:
        require_loopback(host)
    assert refusal.value.code == "server.host_not_loopback"
    assert host in refusal.value.message


def test_unknown_host_is_refused() -> None:
    with pytest.raises(InputError) as refusal:
        require_loopback("no-such-host.invalid")
    assert refusal.value.code == "server.host_unknown"


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
