"""What jobs may take of a host: the smallest limit of the control groups we are in counts."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError

from core.schema.expectation import JobQueue
from store.host_memory import SHARE_OF_JOBS, budget_bytes, physical_bytes
from store.settings import Settings

MIB = 1024**2


def group(root: Path, told: str, limits: dict[str, str]) -> Path:
    (root / "proc/self").mkdir(parents=True)
    (root / "proc/self/cgroup").write_text(told)
    for name, limit in limits.items():
        path = root / "sys/fs/cgroup" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(limit + "\n")
    return root


def test_without_control_groups_the_machine_counts(tmp_path: Path) -> None:
    assert budget_bytes(tmp_path) == int(SHARE_OF_JOBS * physical_bytes())


@pytest.mark.parametrize(
    ("told", "limits", "mib"),
    [
        ("0::/\n", {"memory.max": str(100 * MIB)}, 100),  # a container sees its own group as the root
        ("0::/lab.slice/worker\n", {"lab.slice/memory.max": str(90 * MIB), "lab.slice/worker/memory.max": "max"}, 90),
        ("0::/a/b\n", {"a/memory.max": str(200 * MIB), "a/b/memory.max": str(80 * MIB)}, 80),
        ("5:cpu:/x\n4:memory:/x\n", {"memory/x/memory.limit_in_bytes": str(70 * MIB)}, 70),
    ],
)
def test_the_smallest_limit_counts(tmp_path: Path, told: str, limits: dict[str, str], mib: int) -> None:
    assert budget_bytes(group(tmp_path, told, limits)) == int(SHARE_OF_JOBS * mib * MIB)


@pytest.mark.parametrize("limit", ["max", str(2**63 - 4096), "nonsense", "0"])
def test_no_limit_is_no_limit(tmp_path: Path, limit: str) -> None:
    root = group(tmp_path, "0::/\n", {"memory.max": limit})
    assert budget_bytes(root) == int(SHARE_OF_JOBS * physical_bytes())


def test_queues_of_a_worker_are_read_and_handed_on(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, worker_queues="heavy")  # type: ignore[arg-type]
    assert settings.worker_queues == (JobQueue.HEAVY,)
    assert settings.as_environment()["INTEGUMENT_WORKER_QUEUES"] == "heavy"
    assert Settings(data_dir=tmp_path).as_environment()["INTEGUMENT_WORKER_QUEUES"] == "fast,heavy"
    for wrong in ("", "slow"):
        with pytest.raises(ValidationError):
            Settings(data_dir=tmp_path, worker_queues=wrong)  # type: ignore[arg-type]
