"""A real receiver of callbacks: an HTTP server in a thread, which notes what comes and answers what it is told to."""

from __future__ import annotations

import ssl
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


@dataclass(frozen=True)
class Received:
    """One request."""

    method: str
    path: str
    headers: dict[str, str]
    body: bytes


@dataclass
class Receiver:
    """`answers` are used up one by one, the last stays: a status, or (status, Location)."""

    address: str
    port: int
    answers: list[int | tuple[int, str]] = field(default_factory=lambda: [204])
    received: list[Received] = field(default_factory=list)
    holding: threading.Event = field(default_factory=threading.Event)  # while set, requests are not answered
    drip: bool = False  # answer without end, a byte at a time

    @property
    def url(self) -> str:
        return f"http://{self.address}:{self.port}/hook?job=1"

    def wait_for(self, count: int, limit_s: float = 30.0) -> list[Received]:
        deadline = time.monotonic() + limit_s
        while len(self.received) < count:
            assert time.monotonic() < deadline, self.received
            time.sleep(0.02)
        return self.received


@contextmanager
def receiving(address: str = "127.0.0.1", port: int = 0, tls: ssl.SSLContext | None = None) -> Iterator[Receiver]:
    """Until the block ends."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
            headers = {name.lower(): value for name, value in self.headers.items()}
            receiver.received.append(Received(self.command, self.path, headers, body))
            while receiver.holding.is_set():
                time.sleep(0.02)
            answer = receiver.answers.pop(0) if len(receiver.answers) > 1 else receiver.answers[0]
            status, location = answer if isinstance(answer, tuple) else (answer, "")
            try:
                if receiver.drip:
                    self.wfile.write(b"HTTP/1.1 200 OK\r\n")
                    for _ in range(200):
                        self.wfile.write(b"x")
                        self.wfile.flush()
                        time.sleep(0.05)
                self.send_response(status)
                if location:
                    self.send_header("Location", location)
                self.send_header("Content-Length", "0")
                self.end_headers()
            except OSError:
                pass  # the deliverer is gone

        do_GET = do_PUT = do_HEAD = do_POST

        def log_message(self, *_: object) -> None:
            """Quiet."""

    class Server(ThreadingHTTPServer):
        daemon_threads = True

        def handle_error(self, *_: object) -> None:
            """A client that breaks off is part of the tests."""

    server = Server((address, port), Handler)
    if tls is not None:
        server.socket = tls.wrap_socket(server.socket, server_side=True, do_handshake_on_connect=False)
    receiver = Receiver(address, int(server.server_address[1]))
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    try:
        yield receiver
    finally:
        receiver.holding.clear()
        server.shutdown()
        thread.join()
        server.server_close()
