"""The API killed in the middle of an upload in pieces: what was acknowledged is there, and a client goes on."""

import hashlib
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import httpx
import pytest

from subjects.body import body
from tests.acceptance.service import Service, binary_stl
from tests.embedded import embedded

TUS = {"Tus-Resumable": "1.0.0"}
PIECE_BYTES = 4 * 1024 * 1024


@pytest.mark.slow
def test_an_upload_goes_on_after_the_api_was_killed(tmp_path: Path) -> None:
    data = binary_stl(body(2))  # 21 MB
    acknowledged = PIECE_BYTES
    with embedded(tmp_path / "data") as server, closing(Service(server.url)) as service:
        created = service.http.post("/v1/uploads", headers={**TUS, "Upload-Length": str(len(data))})
        upload = created.headers["Location"]
        send(service, upload, 0, data[:acknowledged])
        api = server.part("api")

        def pieces() -> Iterator[bytes]:
            yield data[acknowledged : 2 * acknowledged]
            written = tmp_path / "data" / "uploads" / upload.rpartition("/")[2]
            await_that(lambda: written.stat().st_size > acknowledged)
            api.send_signal(signal.SIGKILL)
            yield data[2 * acknowledged :]

        with pytest.raises(httpx.TransportError):
            send(service, upload, acknowledged, pieces())
        server.part("api", other_than=api.pid)
        with closing(Service(server.url)) as again:
            await_that(lambda: is_up(again))
            told = again.http.head(upload, headers=TUS)
            assert told.status_code == 200
            assert int(told.headers["Upload-Offset"]) == acknowledged
            send(again, upload, acknowledged, data[acknowledged:])
            made = again.http.post(f"{upload}/mesh")
            assert made.status_code == 201, made.text
            assert made.json()["sha256"] == hashlib.sha256(data).hexdigest()
            assert made.json()["faces"] == 428_096


def send(service: Service, upload: str, offset: int, data: bytes | Iterator[bytes]) -> None:
    headers = {**TUS, "Upload-Offset": str(offset), "Content-Type": "application/offset+octet-stream"}
    answer = service.http.patch(upload, content=data, headers=headers)
    assert answer.status_code == 204, answer.text


def is_up(service: Service) -> bool:
    try:
        return service.http.get("/healthz").status_code == 200
    except httpx.TransportError:
        return False


def await_that(holds: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.02)
