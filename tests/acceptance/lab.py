"""The lab set-up on one machine: the commands of docker-compose.yml beside a real PostgreSQL and a Valkey of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path

import httpx

from server.address import choose_port
from server.tether import tie_to_parent
from tests.project.compose import SECRETS, read_compose

START_S = 90.0
STOP_S = 60.0


@contextmanager
def lab(folder: Path, database_url: str, broker_url: str) -> Iterator[str]:
    """Migrate, then run API and worker until the end of the block; gives the URL of the API."""
    services = read_compose(SECRETS)["services"]
    port = choose_port("127.0.0.1", 0)
    # what only a network of containers has gets its counterpart here; everything else is as the file says
    here = {
        "INTEGUMENT_DATA_DIR": str(folder / "data"),
        "INTEGUMENT_DATABASE_URL": database_url,
        "INTEGUMENT_BROKER_URL": broker_url,
    }
    api_here = {"INTEGUMENT_HOST": "127.0.0.1", "INTEGUMENT_PORT": str(port)}

    def start(name: str) -> subprocess.Popen[bytes]:
        service = services[name]
        python, *arguments = service["command"]
        assert python == "python"
        variables = {**service["environment"], **here, **(api_here if name == "api" else {})}
        with (folder / f"{name}.log").open("wb") as log:
            return subprocess.Popen(
                [sys.executable, *arguments],
                env={**os.environ, **variables},
                stdout=log,
                stderr=log,
                cwd=folder,
                preexec_fn=partial(tie_to_parent, os.getpid()),
            )

    assert start("migrate").wait(START_S) == 0, (folder / "migrate.log").read_text()
    with ExitStack() as running:
        worker, api = start("worker"), start("api")
        running.callback(_stop, worker)
        running.callback(_stop, api)
        url = f"http://127.0.0.1:{port}"
        deadline = time.monotonic() + START_S
        while not _is_ready(url):
            assert api.poll() is None, (folder / "api.log").read_text()
            assert time.monotonic() < deadline, (folder / "api.log").read_text()
            time.sleep(0.1)
        yield url


def _is_ready(url: str) -> bool:
    try:
        return httpx.get(f"{url}/readyz", timeout=5, trust_env=False).status_code == 200
    except httpx.TransportError:
        return False


def _stop(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGTERM)
    assert process.wait(STOP_S) == 0
