"""Small jobs in number: how many a second, and what the service adds to each."""

from __future__ import annotations

import asyncio
import time

from benchmarks.load.bare import Bare
from benchmarks.load.client import Client, client_of, moment
from benchmarks.load.measure import Measure, Part, latency
from benchmarks.load.memory import Memory
from benchmarks.load.size import Size
from benchmarks.load.stand import Stand

OVERHEAD_MS = 60.0
SCALING = 1.7


async def work(stand: Stand, size: Size) -> Part:
    """So many clients, each sends a job and waits for its end before the next, until all jobs are done."""
    async with client_of(stand) as client:
        skin = await client.small_mesh()
        await client.ended((await client.execute("validate", {"meshes": {"href": skin}}))[0])
        numbers = iter(range(size.jobs))
        accepted_s: list[float] = []

        async def one() -> None:
            for _ in numbers:
                job, took_s = await client.execute("validate", {"meshes": {"href": skin}})
                accepted_s.append(took_s)
                await client.ended(job)

        began = time.perf_counter()
        with Memory(stand.api) as memory:
            await asyncio.gather(*(one() for _ in range(size.clients)))
        took_s = time.perf_counter() - began
    name = f"{size.jobs} jobs of {size.clients} clients"
    return Part(
        name,
        (
            Measure(f"{name}, per second", size.jobs / took_s, "jobs/s"),
            *latency(f"{name}, accept", accepted_s),
            Measure(f"{name}, memory the API grew by", memory.growth_mib, "MiB"),
        ),
        tuple(client.errors),
        memory.series,
    )


async def cost(stand: Stand, size: Size, bare: Bare) -> Part:
    """Jobs that wait in a row for one warm worker: time from the start of the first to the end of the last."""
    async with client_of(stand) as client:
        skin = await client.small_mesh()
        await client.ended((await client.execute("validate", {"meshes": {"href": skin}}))[0])
        before = stand.cpu_s()
        wall_s = await _in_a_row(client, skin, size.overhead_jobs) / size.overhead_jobs
        cpu_s = (stand.cpu_s() - before) / size.overhead_jobs
    return Part(
        "overhead",
        (
            Measure("bare job: reading and checking", 1000 * bare.check_s, "ms"),
            Measure("bare job with its report", 1000 * bare.wall_s, "ms"),
            Measure("the same through the service", 1000 * wall_s, "ms"),
            Measure("overhead per job", 1000 * (wall_s - bare.wall_s), "ms", OVERHEAD_MS),
            Measure("overhead per job in processor time, all processes", 1000 * (cpu_s - bare.cpu_s), "ms"),
        ),
        tuple(client.errors),
    )


async def pace(stand: Stand, size: Size) -> tuple[float, tuple[str, ...]]:
    """Jobs per second of these workers, and what went wrong."""
    async with client_of(stand) as client:
        skin = await client.small_mesh()
        warm = [await client.execute("validate", {"meshes": {"href": skin}}) for _ in range(4 * len(stand.workers))]
        for job, _ in warm:
            await client.ended(job)
        return size.scaling_jobs / await _in_a_row(client, skin, size.scaling_jobs), tuple(client.errors)


def compare(one: float, two: float, errors: tuple[str, ...]) -> Part:
    """The pace of two workers and that of one."""
    return Part(
        "two workers",
        (
            Measure("jobs per second, one worker", one, "jobs/s"),
            Measure("jobs per second, two workers", two, "jobs/s"),
            Measure("two workers against one", two / one, "times", SCALING, at_least=True),
        ),
        errors,
    )


async def _in_a_row(client: Client, skin: str, jobs: int) -> float:
    """Seconds from the start of the first to the end of the last, by the clock of the job table."""
    accepted = [await client.execute("validate", {"meshes": {"href": skin}}) for _ in range(jobs)]
    ended = [await client.ended(job) for job, _ in accepted]
    return max(moment(job["finished"]) for job in ended) - min(moment(job["started"]) for job in ended)
