"""What a seed stands for: which jobs are sent when, and what goes wrong when. Nothing else decides."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass

from tests.acceptance.faults.fault import Fault, Kind
from tests.acceptance.faults.workload import VARIANTS, Request

HOSTS = ("worker-1", "worker-2")
CLIENTS = 5
TAIL_S = 3.0  # the last jobs are sent before the last fault ends
DISMISSED_SHARE = 0.06
LONGEST_JUMP_H = 30.0

# (kind, targets, shortest and longest duration in seconds, weight)
MENU: tuple[tuple[Kind, tuple[str, ...], float, float, float], ...] = (
    (Kind.KILL, HOSTS, 0.5, 4.0, 3),
    (Kind.RESTART, HOSTS, 0.0, 0.0, 1.5),
    (Kind.PAUSE, HOSTS, 1.0, 8.0, 2),
    (Kind.KILL, tuple(f"child of {host}" for host in HOSTS), 0.0, 0.0, 3),
    (Kind.PAUSE, tuple(f"child of {host}" for host in HOSTS), 1.0, 6.0, 1),
    (Kind.KILL, tuple(f"nursery of {host}" for host in HOSTS), 0.0, 0.0, 1.5),
    (Kind.PAUSE, tuple(f"nursery of {host}" for host in HOSTS), 1.0, 6.0, 1),
    (Kind.KILL, ("api",), 0.2, 2.0, 2.5),
    (Kind.RESTART, ("api",), 0.0, 0.0, 1),
    (Kind.PAUSE, ("api",), 1.0, 5.0, 1.5),
    (Kind.KILL, ("valkey",), 0.2, 4.0, 1.5),
    (Kind.EMPTY, ("valkey",), 0.2, 4.0, 2),
    (Kind.PAUSE, ("valkey",), 1.0, 8.0, 1.5),
    (Kind.KILL, ("postgres",), 0.2, 4.0, 1.5),
    (Kind.KILL, ("connection of postgres",), 0.0, 0.0, 1),
    (Kind.RESTART, ("postgres",), 0.0, 0.0, 1),
    (Kind.PAUSE, ("postgres",), 1.0, 8.0, 1.5),
    (Kind.REFUSE, ("store",), 1.0, 8.0, 2),
    (Kind.HANG, ("store",), 1.0, 8.0, 1),
    (Kind.CUT, ("store",), 1.0, 8.0, 1),
    (Kind.CUT, tuple(f"database of {host}" for host in (*HOSTS, "api")), 1.0, 10.0, 2),
    (Kind.HANG, tuple(f"database of {host}" for host in (*HOSTS, "api")), 1.0, 10.0, 1),
    (Kind.FILL, tuple(f"disk of {host}" for host in (*HOSTS, "api")), 1.0, 8.0, 2.5),
    (Kind.JUMP, tuple(f"clock of {host}" for host in (*HOSTS, "api")), 4.0, 15.0, 2.5),
)


@dataclass(frozen=True, slots=True)
class Plan:
    """Both in the order of their time."""

    seed: int
    requests: tuple[Request, ...]
    faults: tuple[Fault, ...]

    @property
    def lasts_s(self) -> float:
        """Until the last job is sent and the last fault is over."""
        return max([fault.ends_s for fault in self.faults] + [request.at_s for request in self.requests])


def draw_plan(seed: int, jobs: int, pace_s: float, faults: int) -> Plan:
    """`jobs` requests, one every `pace_s` on average, and `faults` faults spread over the same time.

    Every line of the menu comes up before any comes up twice, so that a long run has seen them all."""
    dice = random.Random(seed)
    lasts_s = jobs * pace_s
    return Plan(seed, _draw_requests(dice, jobs, lasts_s), _draw_faults(dice, faults, lasts_s))


def _draw_requests(dice: random.Random, jobs: int, lasts_s: float) -> tuple[Request, ...]:
    moments = sorted(dice.uniform(0.0, max(0.0, lasts_s - TAIL_S)) for _ in range(jobs))
    variants = _deal(dice, range(len(VARIANTS)), [1.0] * len(VARIANTS), jobs)
    requests = []
    for number, (at_s, variant) in enumerate(zip(moments, variants, strict=True)):
        dismissed = dice.random() < DISMISSED_SHARE
        dismissed_after_s = dice.uniform(0.0, 4.0) if dismissed else None
        requests.append(Request(number, at_s, dice.randrange(CLIENTS), variant, f"faults-{seed_of(dice)}", dismissed_after_s))
    return tuple(requests)


def seed_of(dice: random.Random) -> str:
    """Part of an Idempotency-Key."""
    return f"{dice.getrandbits(64):016x}"


def _draw_faults(dice: random.Random, faults: int, lasts_s: float) -> tuple[Fault, ...]:
    moments = sorted(dice.uniform(0.5, lasts_s) for _ in range(faults))
    lines = _deal(dice, range(len(MENU)), [weight for *_, weight in MENU], faults)
    drawn = []
    for at_s, line in zip(moments, lines, strict=True):
        kind, targets, shortest_s, longest_s, _ = MENU[line]
        hours = dice.choice((-1, 1)) * dice.uniform(1.0, LONGEST_JUMP_H) if kind is Kind.JUMP else 0.0
        drawn.append(Fault(at_s, dice.uniform(shortest_s, longest_s), kind, dice.choice(targets), dice.getrandbits(16), hours))
    return tuple(drawn)


def _deal(dice: random.Random, lines: range, weights: Sequence[float], number: int) -> list[int]:
    dealt = dice.sample(lines, len(lines))[:number]
    dealt += dice.choices(lines, weights, k=number - len(dealt))
    dice.shuffle(dealt)
    return dealt
