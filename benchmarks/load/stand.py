"""The server under load: the embedded set-up or a lab, started for one measurement in a folder of its own."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from urllib.request import Request, urlopen

import psutil

from tests.acceptance.lab import lab
from tests.embedded import embedded
from tests.postgres import running_postgres
from tests.seaweed import running_seaweed
from tests.valkey import running_valkey

SETUPS = ("embedded", "lab")
WRITE_S, ATTEMPTS = 3.0, 10
UNLIMITED = {"INTEGUMENT_QUOTA_JOBS": "0", "INTEGUMENT_RATE_PER_S": "0"}


@dataclass(frozen=True, slots=True)
class Stand:
    """A server that answers at `url`, and its processes. blobs_url: of its object store, if it has one."""

    url: str
    headers: dict[str, str]
    folder: Path
    api: psutil.Process
    workers: tuple[psutil.Process, ...]
    others: tuple[psutil.Process, ...]
    blobs_url: str = ""

    @contextmanager
    def workers_at_rest(self) -> Iterator[None]:
        """Stopped for the block, so nothing but the API takes the processor. For idle workers, and for less than a lease."""
        stopped = [process for worker in self.workers for process in (worker, *worker.children(recursive=True))]
        try:
            for _ in range(ATTEMPTS):
                for process in stopped:
                    process.suspend()
                if self._can_write():
                    break
                for process in stopped:  # one was stopped in the middle of a transaction
                    process.resume()
                time.sleep(0.5)
            yield
        finally:
            for process in stopped:
                process.resume()

    def _can_write(self) -> bool:
        headers = {**self.headers, "Tus-Resumable": "1.0.0", "Upload-Length": "1"}
        request = Request(self.url + "/v1/uploads", method="POST", headers=headers)
        try:
            return bool(urlopen(request, timeout=WRITE_S).status == 201)
        except OSError:
            return False

    def cpu_s(self) -> float:
        """Processor time of everything that serves, ended children included."""
        return sum(map(cpu_s_of, (self.api, *self.workers, *self.others)))


def cpu_s_of(process: psutil.Process) -> float:
    """Of a process with all it ever started and waited for."""
    total = 0.0
    for member in (process, *process.children(recursive=True)):
        with suppress(psutil.NoSuchProcess):
            times = member.cpu_times()
            total += times.user + times.system + times.children_user + times.children_system
    return total


@contextmanager
def stand(setup: str, *, slots: int = 1, hosts: int = 1) -> Iterator[Stand]:
    """Start, and stop at the end of the block; `hosts` workers (one where the set-up is embedded) of `slots` jobs each."""
    settings = {**UNLIMITED, "INTEGUMENT_WORKER_CONCURRENCY": str(slots)}
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="itg-load-")))
        yield stack.enter_context(_embedded(folder, settings) if setup == "embedded" else _lab(folder, settings, hosts))


@contextmanager
def _embedded(folder: Path, settings: dict[str, str]) -> Iterator[Stand]:
    with embedded(folder / "data", settings) as server:
        parts = [server.part(name) for name in ("api", "worker", "valkey")]
        yield Stand(server.url, {}, folder / "data", parts[0], (parts[1],), (parts[2],))


@contextmanager
def _lab(folder: Path, settings: dict[str, str], hosts: int) -> Iterator[Stand]:
    with ExitStack() as stack:
        postgres = stack.enter_context(running_postgres())
        valkey = stack.enter_context(running_valkey())
        seaweed = stack.enter_context(running_seaweed())
        blobs_url = seaweed.new_bucket()
        there = stack.enter_context(
            lab(folder, postgres.new_database(), valkey.url, blobs_url=blobs_url, hosts=hosts, **settings)
        )
        workers = tuple(psutil.Process(process.pid) for process in there.workers.values())
        known = {process.pid for process in workers}
        api = next(
            child for child in psutil.Process().children() if child.pid not in known and child.cmdline()[1:3] == ["-m", "api"]
        )
        servers = tuple(psutil.Process(one.process.pid) for one in (postgres, valkey, seaweed) if one.process is not None)
        yield Stand(there.url, {"Authorization": f"Bearer {there.key}"}, folder, api, workers, servers, blobs_url)
