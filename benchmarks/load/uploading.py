"""Files as large as they come: how fast against the disk itself, and how much memory of the API they take."""

from __future__ import annotations

import asyncio
import subprocess
import tempfile
import time
from collections.abc import AsyncIterator
from pathlib import Path

import aiohttp

from benchmarks.load.client import Client, client_of
from benchmarks.load.measure import Measure, Part
from benchmarks.load.memory import Memory
from benchmarks.load.size import MIB, Size
from benchmarks.load.stand import Stand
from tests.acceptance.service import binary_stl
from tests.solids import sphere

SHARE = 0.6
GROWTH_MIB = 64.0
TUS = {"Tus-Resumable": "1.0.0"}
PIECE = {**TUS, "Content-Type": "application/offset+octet-stream"}
READ_BYTES = 4 * MIB


async def upload(stand: Stand, size: Size) -> Part:
    """One file in one request, then several smaller ones at once; `dd` writes the same file before and after."""
    with tempfile.TemporaryDirectory(dir=stand.folder) as name:
        file, copy = Path(name) / "large.stl", Path(name) / "copy"
        write_stl(file, size.upload_bytes)
        disk = [dd_mib_per_s(file, copy)]
        async with client_of(stand) as client:
            with Memory(stand.api) as memory:
                alone_s = await _send(client, file, file.stat().st_size)
            disk.append(dd_mib_per_s(file, copy))
            with Memory(stand.api) as crowd:
                began = time.perf_counter()
                share = file.stat().st_size // size.uploads_at_once
                await asyncio.gather(*(_send(client, file, share) for _ in range(size.uploads_at_once)))
                together_s = time.perf_counter() - began
        mib = file.stat().st_size / MIB
    speed, dd = mib / alone_s, sum(disk) / len(disk)
    name = f"upload of {mib:.0f} MiB"
    return Part(
        "uploads",
        (
            Measure("dd with conv=fsync, same file", dd, "MiB/s"),
            Measure(name, speed, "MiB/s"),
            Measure(f"{name} against dd", speed / dd, "times", SHARE, at_least=True),
            Measure(f"{name}, memory the API grew by", memory.growth_mib, "MiB", GROWTH_MIB),
            Measure(f"{size.uploads_at_once} uploads at once", mib / together_s, "MiB/s"),
            Measure(f"{size.uploads_at_once} uploads at once, memory the API grew by", crowd.growth_mib, "MiB", GROWTH_MIB),
        ),
        tuple(client.errors),
        memory.series,
    )


async def _send(client: Client, file: Path, length: int) -> float:
    """Seconds from the first byte to the answer that all are safe."""
    try:
        async with client.session.post("/v1/uploads", headers={**TUS, "Upload-Length": str(length)}) as created:
            created.raise_for_status()
            where = created.headers["Location"]
    except aiohttp.ClientError as error:
        client.errors.append(f"upload: {error}")
        return float("nan")
    _, took_s = await client.ask("PATCH", where, 204, data=_read(file, length), headers={**PIECE, "Upload-Offset": "0"})
    await client.ask("DELETE", where, 204, headers=TUS)
    return took_s


async def _read(path: Path, length: int) -> AsyncIterator[bytes]:
    with path.open("rb") as file:
        while length and (piece := file.read(min(READ_BYTES, length))):
            length -= len(piece)
            yield piece


def write_stl(path: Path, size_bytes: int) -> None:
    """A binary STL of about that size: one ball again and again."""
    ball = binary_stl(sphere(100.0, subdivisions=5))
    facets = ball[84:]
    times = max(1, (size_bytes - 84) // len(facets))
    with path.open("wb") as file:
        file.write(ball[:80] + (times * len(facets) // 50).to_bytes(4, "little"))
        for _ in range(times):
            file.write(facets)


def dd_mib_per_s(source: Path, target: Path) -> float:
    """What the disk does at its best."""
    began = time.perf_counter()
    command = ["dd", f"if={source}", f"of={target}", "bs=1M", "conv=fsync"]
    subprocess.run(command, check=True, capture_output=True)
    took_s = time.perf_counter() - began
    target.unlink()
    return source.stat().st_size / MIB / took_s
