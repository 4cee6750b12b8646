"""The lab set-up on one machine: the commands of docker-compose.yml beside a real PostgreSQL and a Valkey of its own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from server.address import choose_port
from server.tether import tie_to_parent
from tests.project.compose import SECRETS, read_compose

START_S = 90.0
STOP_S = 60.0


@dataclass(frozen=True)
class Lab:
    """A running lab: where its API is, a key for it, and its workers by the name of their host."""

    url: str
    key: str
    workers: Mapping[str, subprocess.Popen[bytes]]


@contextmanager
def lab(
    folder: Path, database_url: str, broker_url: str, *, blobs_url: str = "", hosts: int = 1, **variables: str
) -> Iterator[Lab]:
    """Migrate, then run API and workers until all are healthy and to the end of the block.

    With `blobs_url` every process has a data folder of its own, as on hosts that share nothing but the three URLs.
    """
    services = read_compose(SECRETS)["services"]
    port = choose_port("127.0.0.1", 0)
    # what only a network of containers has gets its counterpart here; everything else is as the file says
    here = {
        "INTEGUMENT_DATABASE_URL": database_url,
        "INTEGUMENT_BROKER_URL": broker_url,
        "INTEGUMENT_BLOBS_URL": blobs_url,
        **variables,
    }
    api_here = {"INTEGUMENT_HOST": "127.0.0.1", "INTEGUMENT_PORT": str(port)}

    def run(name: str, command: list[str], host: str, log_name: str) -> subprocess.Popen[bytes]:
        python, *arguments = command
        assert python == "python"
        data_dir = {"INTEGUMENT_DATA_DIR": str(folder / (host if blobs_url else "data"))}
        given = {**services[name]["environment"], **here, **data_dir, **(api_here if name == "api" else {})}
        with (folder / f"{log_name}.log").open("wb") as log:
            return subprocess.Popen(
                [sys.executable, *(argument.replace("127.0.0.1:8000", f"127.0.0.1:{port}") for argument in arguments)],
                env={**os.environ, **given},
                stdout=log,
                stderr=log,
                cwd=folder,
                preexec_fn=partial(tie_to_parent, os.getpid()),
            )

    def await_health(name: str, host: str, process: subprocess.Popen[bytes]) -> None:
        kind, *check = services[name]["healthcheck"]["test"]
        assert kind == "CMD"
        deadline = time.monotonic() + START_S
        while run(name, check, host, f"{host}-health").wait(START_S) != 0:
            assert process.poll() is None, (folder / f"{host}.log").read_text()
            assert time.monotonic() < deadline, (folder / f"{host}-health.log").read_text()

    assert run("migrate", services["migrate"]["command"], "api", "migrate").wait(START_S) == 0, (
        folder / "migrate.log"
    ).read_text()
    make_key = ["python", "-m", "server.admin", "--json", "keys", "create"]
    assert run("migrate", make_key, "api", "key").wait(START_S) == 0, (folder / "key.log").read_text()
    key = json.loads((folder / "key.log").read_text().partition("}")[0] + "}")["key"]  # the note of stderr follows
    with ExitStack() as running:
        workers = {}
        for name, host in (*(("worker", f"worker-{number}") for number in range(1, hosts + 1)), ("api", "api")):
            process = run(name, services[name]["command"], host, host)
            running.callback(_stop, process)
            if name == "worker":
                workers[host] = process
            await_health(name, host, process)
        yield Lab(f"http://127.0.0.1:{port}", key, workers)


def _stop(process: subprocess.Popen[bytes]) -> None:
    if process.poll() == -signal.SIGKILL:  # a test's doing
        return
    process.send_signal(signal.SIGTERM)
    assert process.wait(STOP_S) == 0
