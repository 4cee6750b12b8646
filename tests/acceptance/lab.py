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

from server.address import choose_port
from server.tether import tie_to_parent
from tests.project.compose import SECRETS, read_compose

START_S = 90.0
STOP_S = 60.0


@contextmanager
def lab(folder: Path, database_url: str, broker_url: str) -> Iterator[str]:
    """Migrate, then run API and worker until both are healthy and to the end of the block; gives the URL of the API."""
    services = read_compose(SECRETS)["services"]
    port = choose_port("127.0.0.1", 0)
    # what only a network of containers has gets its counterpart here; everything else is as the file says
    here = {
        "INTEGUMENT_DATA_DIR": str(folder / "data"),
        "INTEGUMENT_DATABASE_URL": database_url,
        "INTEGUMENT_BROKER_URL": broker_url,
    }
    api_here = {"INTEGUMENT_HOST": "127.0.0.1", "INTEGUMENT_PORT": str(port)}

    def run(name: str, command: list[str], log_name: str) -> subprocess.Popen[bytes]:
        python, *arguments = command
        assert python == "python"
        variables = {**services[name]["environment"], **here, **(api_here if name == "api" else {})}
        with (folder / f"{log_name}.log").open("wb") as log:
            return subprocess.Popen(
                [sys.executable, *(argument.replace("127.0.0.1:8000", f"127.0.0.1:{port}") for argument in arguments)],
                env={**os.environ, **variables},
                stdout=log,
                stderr=log,
                cwd=folder,
                preexec_fn=partial(tie_to_parent, os.getpid()),
            )

    def await_health(name: str, process: subprocess.Popen[bytes]) -> None:
        kind, *check = services[name]["healthcheck"]["test"]
        assert kind == "CMD"
        deadline = time.monotonic() + START_S
        while run(name, check, f"{name}-health").wait(START_S) != 0:
            assert process.poll() is None, (folder / f"{name}.log").read_text()
            assert time.monotonic() < deadline, (folder / f"{name}-health.log").read_text()

    assert run("migrate", services["migrate"]["command"], "migrate").wait(START_S) == 0, (folder / "migrate.log").read_text()
    with ExitStack() as running:
        for name in ("worker", "api"):
            process = run(name, services[name]["command"], name)
            running.callback(_stop, process)
            await_health(name, process)
        yield f"http://127.0.0.1:{port}"


def _stop(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGTERM)
    assert process.wait(STOP_S) == 0
