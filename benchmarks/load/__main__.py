"""`make load`, or `python -m benchmarks.load`: starts its own server on loopback, loads it, prints a table and stops."""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import platform
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

from benchmarks.load.accepting import accept
from benchmarks.load.bare import measure_bare
from benchmarks.load.dismissing import dismiss
from benchmarks.load.listening import listen
from benchmarks.load.measure import Part
from benchmarks.load.size import FULL, SMALL, Size
from benchmarks.load.stand import SETUPS, stand
from benchmarks.load.uploading import upload
from benchmarks.load.working import compare, cost, pace, work
from benchmarks.table import print_table

PARTS = ("accept", "work", "cost", "listen", "upload", "dismiss", "scale")


def main() -> int:
    """Exit code 1 if anything at all went wrong; a number that was missed is said in the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.load", description=__doc__)
    parser.add_argument("--small", action="store_true", help="a few of everything: whether it works, not how fast")
    parser.add_argument("--share", type=float, default=1.0, help="part of the jobs, listeners and bytes of a full run")
    parser.add_argument("--setup", choices=SETUPS, default="embedded", help="lab: PostgreSQL, Valkey and an object store")
    parser.add_argument("--only", choices=PARTS, action="append", help="one of the parts; may be repeated")
    parser.add_argument("--out", type=Path, default=Path("out/load"), help="folder for the numbers as JSON")
    chosen = parser.parse_args()
    size = SMALL if chosen.small else FULL if chosen.share == 1.0 else FULL.part(chosen.share)
    wanted = set(chosen.only or PARTS)
    parts = []
    for part in _run(chosen.setup, size, wanted):
        print_table(part.name, ("measured", "is", "promised", "holds"), [measure.row() for measure in part.measures])
        for error in part.errors[:10]:
            print(f"error: {error}", flush=True)
        parts.append(part)
    chosen.out.mkdir(parents=True, exist_ok=True)
    where = chosen.out / f"{chosen.setup}-{size.name}.json"
    where.write_text(json.dumps(_document(chosen.setup, size, parts), indent=1) + "\n", encoding="utf-8")
    errors = sum(len(part.errors) for part in parts)
    print(f"{errors} errors; all numbers are in {where}")
    return 1 if errors else 0


def _run(setup: str, size: Size, wanted: set[str]) -> Iterator[Part]:
    """Each measurement has a fresh server; a small run has one for all."""
    cores = len(os.sched_getaffinity(0))
    if size is SMALL:
        with stand(setup, slots=cores) as there:
            if "accept" in wanted:
                yield asyncio.run(accept(there, size, at_rest=True))
            if "work" in wanted:
                yield asyncio.run(work(there, size))
            if "listen" in wanted:
                yield asyncio.run(listen(there, size))
            if "upload" in wanted:
                yield asyncio.run(upload(there, size))
            if "dismiss" in wanted:
                yield asyncio.run(dismiss(there, size))
        return
    if "accept" in wanted:
        for at_rest in (True, False):
            with stand(setup, slots=cores) as there:
                yield asyncio.run(accept(there, size, at_rest=at_rest))
    if "work" in wanted:
        with stand(setup, slots=cores) as there:
            yield asyncio.run(work(there, size))
    if "cost" in wanted:
        bare = measure_bare(size.overhead_jobs)
        with stand(setup) as there:
            yield asyncio.run(cost(there, size, bare))
    if "listen" in wanted:
        with stand(setup, slots=cores) as there:
            yield asyncio.run(listen(there, size))
    if "upload" in wanted:
        with stand(setup) as there:
            yield asyncio.run(upload(there, size))
    if "dismiss" in wanted:
        with stand(setup) as there:
            yield asyncio.run(dismiss(there, size))
    if "scale" in wanted:
        # workers of the embedded set-up are slots of one process; in a lab they are hosts of one slot each
        with stand(setup) as there:
            one, errors = asyncio.run(pace(there, size))
        with stand(setup, hosts=2) if setup == "lab" else stand(setup, slots=2) as there:
            two, more = asyncio.run(pace(there, size))
        yield compare(one, two, errors + more)


def _document(setup: str, size: Size, parts: list[Part]) -> dict[str, object]:
    return {
        "setup": setup,
        "size": asdict(size),
        "cores": len(os.sched_getaffinity(0)),
        "python": platform.python_version(),
        "parts": [{**asdict(part), "holds": [measure.holds for measure in part.measures]} for part in parts],
    }


if __name__ == "__main__":
    sys.exit(main())
