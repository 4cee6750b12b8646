"""One embedded server for all acceptance tests that do not kill it, and the main job run on it once."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from core.mesh import Mesh
from subjects.body import body
from tests.acceptance.service import FINISHED, Service, unpack_shells
from tests.embedded import Embedded, embedded


@dataclass(frozen=True)
class MainJob:
    """The job of the demo, done."""

    job: str
    seconds: float
    seen: tuple[dict[str, Any], ...]
    status: dict[str, Any]
    package: bytes
    shells: dict[str, Mesh]


@pytest.fixture(scope="session")
def data_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("acceptance") / "data"


@pytest.fixture(scope="session")
def server(data_dir: Path) -> Iterator[Embedded]:
    with embedded(data_dir) as server:
        yield server


@pytest.fixture(scope="session")
def service(server: Embedded) -> Iterator[Service]:
    with closing(Service(server.url)) as service:
        yield service


@pytest.fixture(scope="session")
def skin(service: Service) -> str:
    """The real body at 26,756 faces, uploaded."""
    return service.upload(body(0), "body")


def run_main_job(service: Service, skin: str) -> MainJob:
    """`shells` with its defaults on a skin."""
    started = time.monotonic()
    job = service.shells(skin)
    seen: list[dict[str, Any]] = []

    def is_over(status: dict[str, Any]) -> bool:
        seen.append(status)
        return status["status"] in FINISHED

    status = service.wait(job, is_over)
    seconds = time.monotonic() - started
    assert status["status"] == "successful", status
    package = service.result(job, "package")
    return MainJob(job, seconds, tuple(seen), status, package, unpack_shells(package))


@pytest.fixture(scope="session")
def main_job(service: Service, skin: str) -> MainJob:
    return run_main_job(service, skin)
