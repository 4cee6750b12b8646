"""One fault run from an undisturbed answer to every question to the count of what the disturbed lab made of it."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from pathlib import Path

from tests.acceptance.faults.census import (
    Census,
    count_jobs,
    look_for_leftovers,
    measure_recoveries,
    read_stumbles,
    unfinished,
)
from tests.acceptance.faults.crowd import Crowd
from tests.acceptance.faults.injector import Injector
from tests.acceptance.faults.plan import Plan
from tests.acceptance.faults.premises import PLACES, Premises, premises
from tests.acceptance.faults.record import complaints, describe_run, table, write_record
from tests.acceptance.faults.small_disks import mount_small_disks
from tests.acceptance.faults.story import Story
from tests.acceptance.faults.workload import VARIANTS, Request, make_meshes

DISK_BYTES = 96 * 1024 * 1024
TICK_S = 0.05
BOUND_S = 300.0  # after the last fault some job has to finish within this, as long as any waits


def run_faults(plan: Plan, folder: Path, path: str, settings: Mapping[str, str], out: Path) -> list[str]:
    """What went wrong, in lines; the table is printed and kept in `out`."""
    for request in plan.requests:
        _tell(f"{request.at_s:7.2f} s  job {request.number}: {VARIANTS[request.variant].process} by client {request.client}")
    for fault in plan.faults:
        _tell(str(fault))
    mount_small_disks((folder / host for host in PLACES), DISK_BYTES)
    meshes = make_meshes()
    (folder / "fetched").mkdir()
    with premises(folder, path, **settings) as there:
        crowd = Crowd(there.lab.url, there.lab.key, meshes, plan, folder / "fetched")
        calm = Crowd(there.lab.url, there.lab.key, meshes, _calm_plan(plan), folder / "fetched")
        expected = _run_undisturbed(calm, there)
        injector = Injector(there, _tell)
        began = time.monotonic()
        crowd.begin()
        _disturb(plan, injector, crowd, began)
        census = Census()
        told = [story.job for story in crowd.stories.values() if story.is_accepted]
        _await_end(there, injector, told)
        crowd.join()
        seconds = time.monotonic() - began
        fetching = crowd.client()
        for story in crowd.stories.values():
            if story.is_accepted and fetching.job(story.job).status == "successful":
                crowd.fetch(fetching, story)
        known = [story.job for story in calm.stories.values()]
        count_jobs(census, there, list(crowd.stories.values()), expected, known)
        measure_recoveries(census, there, injector.robbed)
        look_for_leftovers(census, there)
        census.stumbles = read_stumbles(there)
        census.client_errors = crowd.errors
    parts = (plan, census, injector.done, len(injector.missed), crowd.refusals, seconds)
    write_record(out, plan.seed, describe_run(*parts), table(*parts))
    print(table(*parts))
    return complaints(census)


def _calm_plan(plan: Plan) -> Plan:
    """Each question of the plan once, at once."""
    variants = sorted({request.variant for request in plan.requests})
    requests = [Request(number, 0.0, number % 5, variant, f"calm-{variant}", None) for number, variant in enumerate(variants)]
    return Plan(plan.seed, tuple(requests), ())


def _run_undisturbed(calm: Crowd, there: Premises) -> dict[int, dict[str, str]]:
    """Digests of the outputs by variant."""
    calm.begin()
    calm.join()
    stories: list[Story] = list(calm.stories.values())
    with calm.client() as client:
        for story in stories:
            client.wait(story.job)
            calm.fetch(client, story)
    _tell(f"{len(stories)} jobs undisturbed, at {there.lab.url}")
    return {story.request.variant: story.sha256 for story in stories}


def _disturb(plan: Plan, injector: Injector, crowd: Crowd, began: float) -> None:
    """Until the last fault is over and the last job is sent."""
    acts = sorted(
        [(fault.at_s, 0, index) for index, fault in enumerate(plan.faults)]
        + [(fault.ends_s, 1, index) for index, fault in enumerate(plan.faults)]
    )
    while acts or time.monotonic() - began < plan.lasts_s:
        now_s = time.monotonic() - began
        while acts and acts[0][0] <= now_s:
            _, is_end, index = acts.pop(0)
            fault = plan.faults[index]
            if is_end:
                injector.end(fault)
            else:
                _tell(f"at {now_s:.2f} s: {fault}")
                injector.begin(fault)
        injector.watch(now_s)
        time.sleep(TICK_S)
    injector.heal()
    while crowd.is_sending:  # who was refused while things were broken tries again
        injector.watch(time.monotonic() - began)
        time.sleep(TICK_S)


def _await_end(there: Premises, injector: Injector, jobs: list[str]) -> None:
    fewest, deadline = len(jobs) + 1, 0.0
    while left := unfinished(there, jobs):
        if len(left) < fewest:  # a slow machine is not a lab that hangs
            fewest, deadline = len(left), time.monotonic() + BOUND_S
        if time.monotonic() > deadline:
            break
        injector.watch(0.0)
        time.sleep(1.0)
    _tell(f"{len(jobs) - len(left)} of {len(jobs)} accepted jobs are finished")


def _tell(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
