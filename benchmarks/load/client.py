"""A client that takes little of the processor it shares with the server."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

import aiohttp

from benchmarks.load.stand import Stand
from tests.acceptance.service import FINISHED, binary_stl
from tests.solids import cube

LIMIT_S = 900.0
LOOK_S = 0.2


@dataclass(slots=True)
class Client:
    """Speaks HTTP to one stand; what went wrong is counted, not raised."""

    session: aiohttp.ClientSession
    errors: list[str] = field(default_factory=list)

    async def ask(self, method: str, path: str, expected: int, **given: Any) -> tuple[bytes, float]:
        """The body of the answer, and after how many seconds it was complete."""
        began = time.perf_counter()
        try:
            async with self.session.request(method, path, **given) as answer:
                body = await answer.read()
        except (aiohttp.ClientError, TimeoutError) as error:
            self.errors.append(f"{method} {path}: {type(error).__name__}: {error}")
            return b"{}", time.perf_counter() - began
        if answer.status != expected:
            self.errors.append(f"{method} {path}: {answer.status} {body[:200]!r}")
            return b"{}", time.perf_counter() - began
        return body, time.perf_counter() - began

    async def small_mesh(self) -> str:
        """A cube of 12 faces, sent; the reference to it."""
        form = aiohttp.FormData({"unit": "mm"})
        form.add_field("file", binary_stl(cube(100.0)), filename="cube.stl")
        body, _ = await self.ask("POST", "/v1/meshes", 201, data=form)
        return f"/v1/meshes/{json.loads(body)['id']}"

    async def execute(self, process: str, inputs: dict[str, Any]) -> tuple[str, float]:
        """The id of an accepted job, and the seconds to the answer."""
        body, took_s = await self.ask("POST", f"/v1/processes/{process}/execution", 201, json={"inputs": inputs})
        return str(json.loads(body).get("jobID", "")), took_s

    async def status(self, job: str) -> dict[str, Any]:
        """statusInfo."""
        body, _ = await self.ask("GET", f"/v1/jobs/{job}", 200)
        return dict(json.loads(body))

    async def ended(self, job: str) -> dict[str, Any]:
        """statusInfo once nothing more happens; anything but success is an error."""
        deadline = time.monotonic() + LIMIT_S
        while (status := await self.status(job)).get("status") not in FINISHED:
            if time.monotonic() > deadline or not status:
                break
            await asyncio.sleep(LOOK_S)
        if status.get("status") != "successful":
            self.errors.append(f"job {job}: {status}")
        return status


@asynccontextmanager
async def client_of(stand: Stand) -> AsyncIterator[Client]:
    """Any number of connections at once."""
    connector = aiohttp.TCPConnector(limit=0)
    patience = aiohttp.ClientTimeout(total=None, sock_connect=30, sock_read=120)
    async with aiohttp.ClientSession(stand.url, connector=connector, headers=stand.headers, timeout=patience) as session:
        yield Client(session)


def moment(text: str) -> float:
    """Seconds of the epoch."""
    return datetime.fromisoformat(text).timestamp()
