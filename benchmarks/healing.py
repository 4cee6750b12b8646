"""The healing corpus as a table: ours against peers, each in a process of its own, all judged alike."""

from __future__ import annotations

import json
import select
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.table import percent, print_table
from core.mesh import Mesh
from subjects.defects import CORPUS, Defective
from subjects.healing_trial import HealingJudgement, judge_healing

OURS = "integument"
PEERS = ("pymeshfix", "pymeshlab, gentle filters", "pymeshlab, all repair filters", "trimesh, all repairs")
LIMIT_S = 120
START_LIMIT_S = 300
HEAD = (
    "method", "healed to ready", "refused by name", "crashed, raised, out of time", "wrong",
    "deviation mm of all: median", "90 %", "of those it healed: median", "ours of the same",
    "sound faces kept", "CPU s median", "total",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Attempt:
    """How one method fared with one entry. outcome: `ready`, `wrong`, `failed`, or the code of a refusal."""

    outcome: str
    seconds: float
    judgement: HealingJudgement | None
    words: str = ""


def compare_healing(*, quick: bool, peers: bool) -> bool:
    """Print both tables; True if nothing of ours is wrong, at least 95 % are healed, and no peer heals as many."""
    numbers = [number for number, entry in enumerate(CORPUS) if entry.quick or not quick]
    attempts: dict[str, dict[int, Attempt]] = {}
    for name in (OURS, *(PEERS if peers else ())):
        attempts[name] = dict(zip(numbers, _try_all(name, numbers), strict=True))
    print_table(
        f"Healing: {len(numbers)} defective surfaces", HEAD, [_row(name, of, attempts[OURS]) for name, of in attempts.items()]
    )
    classes = sorted({kind for number in numbers for kind in CORPUS[number].classes})
    print_table(
        "Healed, by class of defect (combinations count in each)",
        ("class", "surfaces", *attempts),
        [_class_row(kind, numbers, attempts) for kind in classes],
    )
    for number, attempt in attempts[OURS].items():
        if attempt.outcome != "ready":
            print(f"- {CORPUS[number].name}: {attempt.outcome} {attempt.words}")
    healed = {name: _count_ready(list(of.values())) for name, of in attempts.items()}
    wrong = sum(attempt.outcome == "wrong" for attempt in attempts[OURS].values())
    return (
        wrong == 0 and healed[OURS] >= 0.95 * len(numbers) and all(healed[OURS] > healed[name] for name in healed if name != OURS)
    )


class _Worker:
    """A child that mends entries one by one."""

    def __init__(self, name: str, folder: str) -> None:
        command = [sys.executable, "-m", "benchmarks.heal_entries", name, folder]
        self.child = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, bufsize=1
        )
        self.answer(START_LIMIT_S)

    def ask(self, number: int) -> dict[str, Any]:
        assert self.child.stdin is not None
        try:
            self.child.stdin.write(f"{number}\n")
            self.child.stdin.flush()
        except BrokenPipeError:
            return {"crashed": True}
        return self.answer(LIMIT_S)

    def answer(self, limit_s: float) -> dict[str, Any]:
        """The next line; a crash or a time-out ends the child."""
        assert self.child.stdout is not None
        ready, _, _ = select.select([self.child.stdout], [], [], limit_s)
        line = self.child.stdout.readline() if ready else ""
        if line:
            told: dict[str, Any] = json.loads(line)
            return told
        self.child.kill()
        self.child.wait()
        return {"crashed": f"exit code {self.child.returncode}"} if ready else {"crashed": f"not done after {limit_s} s"}

    @property
    def is_alive(self) -> bool:
        return self.child.poll() is None


def _try_all(name: str, numbers: Sequence[int]) -> Iterator[Attempt]:
    with tempfile.TemporaryDirectory(prefix="bench-") as folder:
        worker = _Worker(name, folder)
        for number in numbers:
            if not worker.is_alive:
                worker = _Worker(name, folder)
            attempt = _judge(CORPUS[number], worker.ask(number), Path(folder) / f"{number}.npz")
            print(f"{name}: {CORPUS[number].name}: {attempt.outcome} {attempt.words}", file=sys.stderr, flush=True)
            yield attempt
        worker.child.kill()
        worker.child.wait()


def _judge(entry: Defective, told: dict[str, Any], file: Path) -> Attempt:
    seconds = float(told.get("seconds", LIMIT_S))
    if "crashed" in told or "failed" in told:
        return Attempt("failed", seconds, None, str(told.get("crashed") or told.get("failed")))
    if "refused" in told:
        return Attempt(str(told["refused"]), seconds, None)
    arrays = np.load(file)
    judgement = judge_healing(entry, entry.make(), Mesh.of(arrays["vertices"], arrays["faces"]))
    return Attempt("wrong" if judgement.broken else "ready", seconds, judgement, "; ".join(judgement.broken)[:300])


def _count_ready(attempts: Sequence[Attempt]) -> int:
    return sum(attempt.outcome == "ready" for attempt in attempts)


def _row(name: str, attempts: dict[int, Attempt], ours: dict[int, Attempt]) -> tuple[str, ...]:
    count = Counter(attempt.outcome for attempt in attempts.values())
    refused = sum(number for outcome, number in count.items() if outcome not in ("ready", "wrong", "failed"))
    judged = {number: attempt.judgement for number, attempt in attempts.items() if attempt.judgement is not None}
    healed = [number for number in judged if attempts[number].outcome == "ready"]
    same = [judgement.deviation_mm for number in healed if (judgement := ours[number].judgement) is not None]
    off = [judgement.deviation_mm for judgement in judged.values()]
    total, seconds = len(attempts), [attempt.seconds for attempt in attempts.values()]
    return (
        name,
        *(percent([number / total], 1) for number in (count["ready"], refused, count["failed"], count["wrong"])),
        _millimetres(median(off)),
        _millimetres(float(np.quantile(off, 0.9))),
        _millimetres(median([judged[number].deviation_mm for number in healed])) if healed else "-",
        _millimetres(median(same)) if same else "-",
        percent([float(np.mean([judgement.kept for judgement in judged.values()]))], 2),
        f"{median(seconds):.2f}",
        f"{sum(seconds):.0f}",
    )


def _millimetres(value: float) -> str:
    """What lies below float32 and the referee's rounding is nothing."""
    return "< 0.0001" if value < 1e-4 else f"{value:.3g}"


def _class_row(kind: str, numbers: Sequence[int], attempts: dict[str, dict[int, Attempt]]) -> tuple[str, ...]:
    of_kind = [number for number in numbers if kind in CORPUS[number].classes]
    return (kind, str(len(of_kind)), *(str(_count_ready([of[number] for number in of_kind])) for of in attempts.values()))
