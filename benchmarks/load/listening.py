"""Event streams: many listeners, silent for a while and then told of all that happens."""

from __future__ import annotations

import asyncio
import json
import time

import aiohttp

from benchmarks.load.client import Client, client_of, moment
from benchmarks.load.measure import Measure, Part, latency
from benchmarks.load.memory import Memory
from benchmarks.load.size import Size
from benchmarks.load.stand import Stand, cpu_s_of

OPEN_S = 20.0  # less than a lease: the workers are at rest meanwhile


async def listen(stand: Stand, size: Size) -> Part:
    """The jobs wait while the streams are opened and counted silent; then they run, and each listener hears its job end."""
    async with client_of(stand) as client:
        skin = await client.small_mesh()
        await client.ended((await client.execute("validate", {"meshes": {"href": skin}}))[0])
        late_s: list[float] = []
        with Memory(stand.api) as memory:
            with stand.workers_at_rest():
                jobs = [(await client.execute("validate", {"meshes": {"href": skin}}))[0] for _ in range(size.watched_jobs)]
                listeners = [
                    asyncio.create_task(_hear(client, jobs[number % len(jobs)], late_s)) for number in range(size.listeners)
                ]
                await _all_opened(late_s, size.listeners)
                before = cpu_s_of(stand.api)
                await asyncio.sleep(size.silence_s)
                silent = (cpu_s_of(stand.api) - before) / size.silence_s
                late_s.clear()  # what had happened before they came
            heard = sum(await asyncio.gather(*listeners))
    name = f"{size.listeners} event streams"
    return Part(
        name,
        (
            Measure(f"{name}, processor time of the API while nothing happens", 100 * silent, "% of a core"),
            Measure(f"{name}, told of the end of their job", heard, "streams", size.listeners, at_least=True),
            *latency(f"{name}, from an event to its listener", late_s),
            Measure(f"{name}, memory the API grew by", memory.growth_mib, "MiB"),
        ),
        tuple(client.errors),
        memory.series,
    )


async def _all_opened(told: list[float], listeners: int) -> None:
    """Until every stream has told that its job was accepted, or it is clear that one never will: an error says so then."""
    deadline = time.monotonic() + OPEN_S
    while len(told) < listeners and time.monotonic() < deadline:
        await asyncio.sleep(0.1)


async def _hear(client: Client, job: str, late_s: list[float]) -> bool:
    """True if the stream ended with `done`."""
    kind = ""
    try:
        async with client.session.get(f"/v1/jobs/{job}/events") as answer:
            if answer.status != 200:
                client.errors.append(f"events of {job}: {answer.status}")
                return False
            async for line in answer.content:
                name, _, value = line.decode().rstrip("\n").partition(": ")
                if name == "event":
                    kind = value
                elif name == "data":
                    late_s.append(time.time() - moment(json.loads(value)["at"]))
    except (aiohttp.ClientError, TimeoutError) as error:
        client.errors.append(f"events of {job}: {type(error).__name__}: {error}")
    return kind == "done"
