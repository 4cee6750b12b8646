"""A job taken back at any stage: until it is dismissed and nothing of it runs any more."""

from __future__ import annotations

import asyncio
import json
import time

import aiohttp

from benchmarks.load.client import Client, client_of
from benchmarks.load.measure import Measure, Part
from benchmarks.load.size import Size
from benchmarks.load.stand import Stand
from subjects.body import body
from tests.acceptance.service import FINISHED, binary_stl
from tests.children import children_at_work

LIMIT_S = 2.0
LOOK_S = 0.02
PATIENCE_S = 300.0
TRIES = 5  # a job that ends between two looks is followed by another one
ENDED = ("successful", "failed")
STORING = "store"  # all is made, and on its way to the store: whether a percentage is told in between is up to the machine


async def dismiss(stand: Stand, size: Size) -> Part:
    """The main job on the real body, dismissed when it is so many % done."""
    took_s: dict[int, float] = {}
    async with client_of(stand) as client:
        form = aiohttp.FormData({"unit": "mm"})
        form.add_field("file", binary_stl(body(0)), filename="body.stl")
        made, _ = await client.ask("POST", "/v1/meshes", 201, data=form)
        skin = f"/v1/meshes/{json.loads(made)['id']}"
        for percent in size.dismissed_at:
            for _ in range(TRIES):
                job, _ = await client.execute("shells", {"skin": {"href": skin}})
                took = await _take_back(client, stand, job) if await _reaches(client, job, percent) else None
                if took is not None:
                    took_s[percent] = took
                    break
    longest = max(took_s.values(), default=float("nan"))
    return Part(
        "dismissals",
        (
            Measure("jobs dismissed, one at each stage", len(took_s), "jobs", len(size.dismissed_at), at_least=True),
            *(Measure(f"dismissed and dead, at {percent} %", took, "s", LIMIT_S) for percent, took in took_s.items()),
            Measure("dismissed and dead, longest", longest, "s", LIMIT_S),
        ),
        tuple(client.errors),
    )


async def _reaches(client: Client, job: str, percent: int) -> bool:
    """False: it was over between two looks."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        status = await client.status(job)
        if status.get("status") in FINISHED:
            return False
        if status.get("status") == "running" and (status["progress"] >= percent or status.get("phase") == STORING):
            return True
        await asyncio.sleep(LOOK_S)
    client.errors.append(f"job {job} never came to {percent} %")
    return False


async def _take_back(client: Client, stand: Stand, job: str) -> float | None:
    """Seconds from the request to a dismissed job of which no process is left; None: it ended before."""
    began = time.perf_counter()
    await client.ask("DELETE", f"/v1/jobs/{job}?keep_ended=true", 200)
    while time.perf_counter() - began < PATIENCE_S:
        status = (await client.status(job)).get("status")
        if status == "dismissed" and not _has_children(stand):
            return time.perf_counter() - began
        if status in ENDED:
            return None
        await asyncio.sleep(LOOK_S)
    client.errors.append(f"job {job} is still {status}")
    return PATIENCE_S


def _has_children(stand: Stand) -> bool:
    """Whether a nursery of the workers still has a child that works."""
    return any(children_at_work(worker) for worker in stand.workers)
