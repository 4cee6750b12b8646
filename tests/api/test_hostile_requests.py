"""Requests nobody sends by accident, over real sockets: answered by name or cut off; the next user notices nothing."""

from __future__ import annotations

import io
import json
import socket
import time
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path

import psutil
import pytest

from api import body_limit, guarded_connection
from store.settings import Settings
from tests.api.live import Live, problem_of, serving

HEAD = b"GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\n"
POST = b"POST /v1/processes/validate/execution HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
NOWHERE = "/v1/meshes/00000000-0000-4000-8000-000000000000"


@pytest.fixture(autouse=True)
def served_after(api: Live) -> Iterator[None]:
    """Whatever was sent, the server serves."""
    yield
    assert api.client.get("/v1/jobs").status_code == 200


def connect(api: Live, from_address: str = "127.0.0.1") -> socket.socket:
    address = ("127.0.0.1", int(api.url.rsplit(":", 1)[1]))
    connection = socket.create_connection(address, timeout=30, source_address=(from_address, 0))
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return connection


def answer(connection: socket.socket) -> tuple[int, dict[str, str], bytes]:
    """Status, headers and body of what comes until the server closes."""
    received = io.BytesIO()
    while piece := connection.recv(65536):
        received.write(piece)
    head, _, body = received.getvalue().partition(b"\r\n\r\n")
    first, *lines = head.decode("latin-1").split("\r\n")
    headers = {name.lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
    return int(first.split()[1]), headers, body


def require_problem(got: tuple[int, dict[str, str], bytes], status: int, code: str) -> None:
    """A problem like any other, with the headers all answers have."""
    assert got[0] == status, got
    assert got[1]["content-type"] == "application/problem+json"
    assert got[1]["x-content-type-options"] == "nosniff"
    assert got[1]["content-security-policy"].startswith("default-src 'none'")
    problem = json.loads(got[2])
    assert problem["code"] == code
    assert problem["request_id"] == got[1]["x-request-id"]


def flood(connection: socket.socket, piece: bytes, most: int) -> int:
    """Send `piece` again and again, up to `most` bytes or until the server has had enough; how much went out."""
    sent = 0
    try:
        while sent < most:
            sent += connection.send(piece)
    except (ConnectionResetError, BrokenPipeError):
        pass
    return sent


@pytest.mark.parametrize("piece", [b"X-Flood: 1\r\n" * 1000, b"x" * 16384], ids=["lines without end", "one line without end"])
def test_headers_without_end_do_not_fill_the_memory(api: Live, piece: bytes) -> None:
    before = psutil.Process().memory_info().rss
    with closing(connect(api)) as connection:
        connection.sendall(HEAD + b"X-First: ")
        assert flood(connection, piece, 200 << 20) < 64 << 20, "the server went on reading"
    assert psutil.Process().memory_info().rss - before < 64 << 20


def test_a_head_that_is_too_large_is_told(api: Live) -> None:
    with closing(connect(api)) as connection:
        connection.sendall(HEAD + b"X: " + b"x" * (guarded_connection.HEAD_BYTES - len(HEAD)) + b"y")
        require_problem(answer(connection), 431, "request.head_too_large")
    with closing(connect(api)) as connection:
        connection.sendall(HEAD + b"X: " + b"x" * 30_000 + b"\r\nConnection: close\r\n\r\n")
        assert answer(connection)[0] == 200


@pytest.mark.parametrize("begin", [b"", b"GET /v1", HEAD, b"\r\n"], ids=["nothing", "half a line", "half a head", "empty lines"])
def test_slow_heads_are_cut_off(api: Live, begin: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guarded_connection, "HEAD_S", 0.5)
    with closing(connect(api)) as connection:
        connection.sendall(begin)
        require_problem(answer(connection), 408, "request.head_too_slow")


def test_a_connection_that_was_good_once_is_no_licence(api: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guarded_connection, "HEAD_S", 0.5)
    with closing(connect(api)) as connection:
        connection.sendall(HEAD + b"\r\n")
        assert connection.recv(65536).startswith(b"HTTP/1.1 200")
        connection.sendall(b"\r\n")  # would be taken for a sign of life
        rest = io.BytesIO()
        while piece := connection.recv(65536):
            rest.write(piece)
        assert b" 408 " in rest.getvalue()


def test_connections_are_counted_by_address(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, connections=6, connections_per_address=3, rate_per_s=0)
    with serving(settings) as live:
        live.client.close()  # it keeps one
        held: list[socket.socket] = []
        try:
            for host in ("127.0.0.2", "127.0.0.3"):
                held += [connect(live, host) for _ in range(3)]
                for connection in held[-3:]:
                    connection.sendall(HEAD + b"\r\n")
                    assert b" 200 " in connection.recv(65536)
                with closing(connect(live, host)) as refused:
                    require_problem(answer(refused), 503, "connections.exceeded")
            with closing(connect(live, "127.0.0.4")) as refused:
                require_problem(answer(refused), 503, "connections.exceeded")
            held.pop().close()
            assert is_served(live, "127.0.0.4"), "a place is free again"
        finally:
            for connection in held:
                connection.close()


def is_served(live: Live, host: str) -> bool:
    """As soon as the server has seen who left."""
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        with closing(connect(live, host)) as connection, suppress(ConnectionError):
            connection.sendall(HEAD + b"Connection: close\r\n\r\n")
            if answer(connection)[0] == 200:
                return True
        time.sleep(0.05)
    return False


def test_an_answer_nobody_reads_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guarded_connection, "UNREAD_S", 0.5)
    with serving(Settings(data_dir=tmp_path)) as live:
        job = live.successful({"package": (bytes(64 << 20), "application/zip", "package.zip")})
        with closing(connect(live)) as connection:
            connection.sendall(f"GET /v1/jobs/{job.id}/results/package HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
            assert connection.recv(1024).startswith(b"HTTP/1.1 200")
            deadline = time.monotonic() + 20
            while is_held_for(connection):
                assert time.monotonic() < deadline
                time.sleep(0.05)
        whole = live.client.get(f"/v1/jobs/{job.id}/results/package")
        assert len(whole.content) == 64 << 20, "whoever reads gets all of it"


def is_held_for(connection: socket.socket) -> bool:
    """Whether the server, which is this process, too, still has its end of it."""
    theirs = connection.getsockname()
    return any(tuple(one.raddr) == theirs for one in psutil.Process().net_connections("tcp4"))


def test_trickling_heads_hold_no_one_up(api: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guarded_connection, "HEAD_S", 1.0)
    trickling = [connect(api) for _ in range(200)]
    try:
        for place in range(len(HEAD)):
            for connection in trickling[::10]:
                flood(connection, HEAD[place : place + 1], 1)
        assert api.client.get("/v1/jobs").status_code == 200
        for connection in trickling:
            connection.settimeout(20)
            assert b" 408 " in connection.recv(4096)
    finally:
        for connection in trickling:
            connection.close()


@pytest.mark.parametrize("framing", [b"Content-Length: 100\r\n\r\n{", b"Transfer-Encoding: chunked\r\n\r\n1\r\n{\r\n"])
def test_bodies_without_end_are_cut_off(api: Live, framing: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(body_limit, "BODY_S", 0.5)
    with closing(connect(api)) as connection:
        connection.sendall(POST + b"Connection: close\r\n" + framing)
        began = time.monotonic()
        while b"Transfer" in framing and time.monotonic() - began < 0.4:  # a byte now and then changes nothing
            connection.sendall(b"1\r\n \r\n")
            time.sleep(0.05)
        require_problem(answer(connection), 408, "request.body_too_slow")


def test_chunks_without_end_are_refused_by_size(api: Live) -> None:
    with closing(connect(api)) as connection:
        connection.sendall(POST + b"Transfer-Encoding: chunked\r\n\r\n")
        assert flood(connection, b"4000\r\n" + b" " * 0x4000 + b"\r\n", 2 << 20) > 1 << 20
        connection.sendall(b"0\r\n\r\n")
        connection.shutdown(socket.SHUT_WR)
        require_problem(answer(connection), 413, "request.too_large")


def test_parts_without_end_are_refused_at_the_first_unknown_one(api: Live) -> None:
    part = b'--b\r\nContent-Disposition: form-data; name="p"\r\n\r\nx\r\n'
    began = time.process_time()
    response = api.client.post(
        "/v1/meshes", content=part * 1000 + b"--b--\r\n", headers={"Content-Type": "multipart/form-data; boundary=b"}
    )
    problem_of(response, 422, "upload.field_unknown")
    named = (
        b'--b\r\nContent-Disposition: form-data; name="file"; filename="a.stl"\r\n' + b"X: y\r\n" * 10_000 + b"\r\nx\r\n--b--\r\n"
    )
    response = api.client.post("/v1/meshes", content=named, headers={"Content-Type": "multipart/form-data; boundary=b"})
    assert 400 <= response.status_code < 500
    assert time.process_time() - began < 10
    assert api.incoming() == []


@pytest.mark.parametrize(
    "ranges",
    [
        "bytes=" + ",".join(f"{n}-{n}" for n in range(2000)),
        "bytes=0-" + "9" * 5000,
        "bytes=" + "-" * 20_000,
        "bytes=" + ",0-" * 5000,
    ],
)
def test_floods_of_ranges_get_the_whole_file_once(api: Live, ranges: str) -> None:
    url = f"/v1/jobs/{api.successful().id}/results/report"
    began = time.process_time()
    whole, many = api.client.get(url), api.client.get(url, headers={"Range": ranges})
    assert (many.status_code, many.content) == (200, whole.content)
    assert time.process_time() - began < 5


@pytest.mark.parametrize(
    "inputs",
    [
        "[" * 100_000 + "]" * 100_000,
        '{"a":' * 100_000 + "1" + "}" * 100_000,
        json.dumps({f"p{number}": number for number in range(40_000)}),
        '{"meshes": {"href": "' + NOWHERE + '"}, "meshes": {"href": "/v2"}}',
        "9" * 100_000,
        "-" + "9" * 4000,
        '{"meshes": 1e400}',
        '{"meshes": -Infinity, "x": NaN}',
        '{"meshes": {"href": "' + "/v1/meshes/" * 80_000 + '"}}',
        '{"\\u0000": "\\u0000"}',
        '{"meshes": {"href": "/v1/meshes/\\u202e\\ud800"}}',
    ],
    ids=["deep lists", "deep objects", "40,000 keys", "keys twice", "digits", "long", "1e400", "NaN", "long link", "zero", "RTL"],
)
def test_bodies_that_are_json_of_a_kind(api: Live, inputs: str) -> None:
    body = f'{{"inputs": {inputs}}}'.encode()
    assert len(body) < body_limit.MAX_BODY_BYTES
    began = time.process_time()
    headers = {"Content-Type": "application/json"}
    response = api.client.post("/v1/processes/validate/execution", content=body, headers=headers)
    assert response.status_code in (400, 422), response.text[:300]
    assert response.json()["code"] in ("request.malformed", "request.invalid", "inputs.invalid", "inputs.unknown_key")
    assert len(response.content) < 64 * 1024, "an answer is no echo"
    assert time.process_time() - began < 10


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("POST", "/v1/processes/shells/execution", '{"inputs": {"layers": [%s]}}'),
        ("POST", "/v1/processes/validate/execution", '{"inputs": {}, "labels": [%s]}'),
        ("POST", "/v1/cohorts", '{"process": "validate", "subjects": [%s]}'),
        ("PATCH", "/v1/jobs/00000000-0000-4000-8000-000000000000", '{"labels": [%s]}'),
    ],
)
def test_bodies_of_half_a_million_values_are_not_looked_into(api: Live, method: str, path: str, body: str) -> None:
    """Each value would be refused with a reason of its own: seconds in which nobody else is answered."""
    for values in ("1," * 500_000, "{}," * 300_000, "\t, \n1" * 60_000):
        content = (body % f"0{values.rstrip(',')}").encode()
        assert len(content) < body_limit.MAX_BODY_BYTES
        began = time.process_time()
        response = api.client.request(method, path, content=content, headers={"Content-Type": "application/json"})
        assert "commas" in problem_of(response, 413, "request.too_large")["detail"]
        assert time.process_time() - began < 1.0


def test_a_million_parameters_are_refused(api: Live) -> None:
    response = api.client.get("/v1/jobs?" + "&".join(f"status=x{n}" for n in range(5000)))
    assert 400 <= response.status_code < 500
    assert len(response.content) < 64 * 1024
    with closing(connect(api)) as connection:
        connection.sendall(b"GET /v1/jobs?")
        flood(connection, b"a=1&" * 4096, 4 << 20)  # a million; most of it is never read
    body = b"&".join(b"inputs=%d" % n for n in range(80_000))
    headers = {"Content-Type": "application/x-www-form-urlencoded"}
    problem_of(api.client.post("/v1/processes/validate/execution", content=body, headers=headers), 415, "request.media_type")


@pytest.mark.parametrize(
    "file_name",
    [
        "../../../etc/passwd",
        "..\\..\\boot.ini",
        "a\x01\x7f\x1b[31mb.stl",
        "\u202egpj.stl",
        "n" * 10_000 + ".stl",
        "CON.stl",
        "",
        ".",
        "a/b\\",
    ],
)
def test_names_lead_nowhere(api: Live, stl: bytes, file_name: str) -> None:
    boundary = b"b"
    name = file_name.encode().replace(b'"', b"")
    body = b'--b\r\nContent-Disposition: form-data; name="file"; filename="' + name + b'"\r\n\r\n' + stl + b"\r\n--b--\r\n"
    headers = {"Content-Type": f"multipart/form-data; boundary={boundary.decode()}"}
    response = api.client.post("/v1/meshes", content=body, headers=headers)
    if response.status_code != 201:
        assert 400 <= response.status_code < 500
        return
    shown = response.json()["name"]
    assert shown.isprintable()
    assert len(shown) <= 100
    assert not {"/", "\\", "\u202e", "\x1b"} & set(shown)
    disposition = api.client.get(f"{response.headers['location']}/file").headers["content-disposition"]
    assert disposition.isascii()
    assert ".." not in disposition.replace("%2E", ".").partition("filename*")[0]


@pytest.mark.parametrize(
    "raw",
    [
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",  # TLS
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET /v1 HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n",
        b"POST /v1/meshes HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        b"GET /v1 HTTP/1.1\r\nHost: localhost\r\nX : y\r\n\r\n",
        b"GET /v1\xff HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"GET /v1?\xff HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
        b"\0" * 100,
    ],
)
def test_what_is_no_http_is_told_so(api: Live, raw: bytes) -> None:
    """Two lengths, spaces in names and the like are how one request is smuggled in another."""
    with closing(connect(api)) as connection:
        connection.sendall(raw)
        require_problem(answer(connection), 400, "request.malformed")
