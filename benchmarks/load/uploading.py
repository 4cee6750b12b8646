"""Files as large as they come: how fast against the disk itself, and how much memory of the API they take."""

from __future__ import annotations

import asyncio
import subprocess
import tempfile
import time
from collections.abc import AsyncIterator
from pathlib import Path

import aiohttp
import boto3

from benchmarks.load.client import Client, client_of
from benchmarks.load.measure import Measure, Part
from benchmarks.load.memory import Memory
from benchmarks.load.size import MIB, Size
from benchmarks.load.stand import Stand, cpu_s_of
from store.s3_place import S3Place
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
        file, other, copy = (Path(name) / one for one in ("large.stl", "other.stl", "copy"))
        write_stl(file, size.upload_bytes)
        write_stl(other, size.upload_bytes, radius_mm=101.0)  # or a store that knows bytes by their digest has them already
        disk = [dd_mib_per_s(file, copy)]
        async with client_of(stand) as client:
            before = _busy_s(stand)
            with Memory(stand.api) as memory:
                alone_s = await _send(client, file, 0, file.stat().st_size)
            api_s, others_s = (after - ahead for after, ahead in zip(_busy_s(stand), before, strict=True))
            disk.append(dd_mib_per_s(file, copy))
            store = [store_mib_per_s(stand.blobs_url, file)] if stand.blobs_url else []
            with Memory(stand.api) as crowd:
                began = time.perf_counter()
                share = other.stat().st_size // size.uploads_at_once
                shares = (_send(client, other, number * share, share) for number in range(size.uploads_at_once))
                await asyncio.gather(*shares)
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
            *(Measure("boto3 straight into the object store, same file", straight, "MiB/s") for straight in store),
            *(Measure(f"{name} against boto3", speed / straight, "times") for straight in store),
            Measure(f"{name}, processor time of the API", 1000 * api_s / mib, "ms/MiB"),
            Measure(f"{name}, processor time of the servers behind it", 1000 * others_s / mib, "ms/MiB"),
            Measure(f"{name}, memory the API grew by", memory.growth_mib, "MiB", GROWTH_MIB),
            Measure(f"{size.uploads_at_once} uploads at once", mib / together_s, "MiB/s"),
            Measure(f"{size.uploads_at_once} uploads at once, memory the API grew by", crowd.growth_mib, "MiB", GROWTH_MIB),
        ),
        tuple(client.errors),
        memory.series,
    )


def _busy_s(stand: Stand) -> tuple[float, float]:
    """Processor time until now: of the API, and of database, broker and object store."""
    return cpu_s_of(stand.api), sum(map(cpu_s_of, stand.others))


async def _send(client: Client, file: Path, start: int, length: int) -> float:
    """Seconds from the first byte to the answer that all are safe."""
    try:
        async with client.session.post("/v1/uploads", headers={**TUS, "Upload-Length": str(length)}) as created:
            created.raise_for_status()
            where = created.headers["Location"]
    except aiohttp.ClientError as error:
        client.errors.append(f"upload: {error}")
        return float("nan")
    _, took_s = await client.ask("PATCH", where, 204, data=_read(file, start, length), headers={**PIECE, "Upload-Offset": "0"})
    await client.ask("DELETE", where, 204, headers=TUS)
    return took_s


async def _read(path: Path, start: int, length: int) -> AsyncIterator[bytes]:
    with path.open("rb") as file:
        file.seek(start)
        while length and (piece := file.read(min(READ_BYTES, length))):
            length -= len(piece)
            yield piece


def write_stl(path: Path, size_bytes: int, radius_mm: float = 100.0) -> None:
    """A binary STL of about that size: one ball again and again."""
    ball = binary_stl(sphere(radius_mm, subdivisions=5))
    facets = ball[84:]
    times = max(1, (size_bytes - 84) // len(facets))
    with path.open("wb") as file:
        file.write(ball[:80] + (times * len(facets) // 50).to_bytes(4, "little"))
        for _ in range(times):
            file.write(facets)


def store_mib_per_s(blobs_url: str, source: Path) -> float:
    """What the object store takes at its best: parts of 8 MiB from ten threads, as boto3 does it unless told otherwise."""
    place = S3Place.of(blobs_url)
    client = boto3.client(
        "s3",
        endpoint_url=place.endpoint,
        region_name=place.region,
        aws_access_key_id=place.key,
        aws_secret_access_key=place.secret,
    )
    began = time.perf_counter()
    client.upload_file(str(source), place.bucket, "straight")
    took_s = time.perf_counter() - began
    client.delete_object(Bucket=place.bucket, Key="straight")
    return source.stat().st_size / MIB / took_s


def dd_mib_per_s(source: Path, target: Path) -> float:
    """What the disk does at its best."""
    began = time.perf_counter()
    command = ["dd", f"if={source}", f"of={target}", "bs=1M", "conv=fsync"]
    subprocess.run(command, check=True, capture_output=True)
    took_s = time.perf_counter() - began
    target.unlink()
    return source.stat().st_size / MIB / took_s
