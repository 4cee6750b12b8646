"""What an API says of itself, or somebody else in its place."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from threading import Thread

import pytest

from server.address import choose_port
from server.readiness import ask_api


@contextmanager
def answering(status: int, body: bytes) -> Iterator[int]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(status)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            """Keep quiet."""

    with HTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        yield server.server_port
        server.shutdown()
        thread.join()


def test_ready_is_no_word() -> None:
    with answering(200, b'{"status": "ready"}') as port:
        assert ask_api("127.0.0.1", port) is None


def test_missing_parts_are_passed_on_as_they_are_named() -> None:
    with answering(503, b'{"detail": "Not ready: disk: 1 bytes are free"}') as port:
        assert ask_api("127.0.0.1", port) == "Not ready: disk: 1 bytes are free"


@pytest.mark.parametrize("body", [b"<html>", b"[]", b"{}", b"\xff\xfe"])
def test_stranger_on_the_port_is_recognised(body: bytes) -> None:
    with answering(404, body) as port:
        assert ask_api("127.0.0.1", port) == f"whoever answers on port {port} is not the API"


def test_silence_is_named() -> None:
    port = choose_port("127.0.0.1", 0)
    assert f"no answer on port {port}" in str(ask_api("127.0.0.1", port))
    with socket.create_server(("127.0.0.1", 0)) as rude:
        Thread(target=lambda: rude.accept()[0].close()).start()
        assert "no answer" in str(ask_api("127.0.0.1", rude.getsockname()[1]))
