"""How long a client waits for `201` when requests come at a steady rate, whether the server keeps up or not (open loop)."""

from __future__ import annotations

import asyncio
import time

from benchmarks.load.client import Client, client_of
from benchmarks.load.measure import Measure, Part, latency
from benchmarks.load.memory import Memory
from benchmarks.load.size import Size
from benchmarks.load.stand import Stand, cpu_s_of

WARM = 4  # jobs before the clock starts: connections, statements, libraries
P99_MS = 50.0


async def accept(stand: Stand, size: Size, *, at_rest: bool) -> Part:
    """`at_rest`: the workers are stopped; else they work on what comes in."""
    name = "workers at rest" if at_rest else "workers at work"
    async with client_of(stand) as client:
        skin = await client.small_mesh()
        warm = [await client.execute("validate", {"meshes": {"href": skin}}) for _ in range(WARM)]
        for job, _ in warm:
            await client.ended(job)
        before = cpu_s_of(stand.api)
        with Memory(stand.api) as memory:
            if at_rest:
                with stand.workers_at_rest():
                    waited_s = await _arrive(client, skin, size)
            else:
                waited_s = await _arrive(client, skin, size)
        cost_ms = 1000 * (cpu_s_of(stand.api) - before) / size.accepted
    measures = latency(f"accept at {size.accept_per_s}/s, {name}", waited_s, P99_MS)
    cost = Measure(f"processor time of the API per accepted job, {name}", cost_ms, "ms")
    return Part(f"accept, {name}", (*measures, cost), tuple(client.errors), memory.series)


async def _arrive(client: Client, skin: str, size: Size) -> list[float]:
    """Seconds from the moment each request was due to its answer."""
    began = time.perf_counter()

    async def one(due: float) -> float:
        await client.execute("validate", {"meshes": {"href": skin}})
        return time.perf_counter() - due

    arrivals = []
    for number in range(size.accepted):
        due = began + number / size.accept_per_s
        await asyncio.sleep(max(0.0, due - time.perf_counter()))
        arrivals.append(asyncio.create_task(one(due)))
    return list(await asyncio.gather(*arrivals))
