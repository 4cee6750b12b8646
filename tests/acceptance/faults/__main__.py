"""`python -m tests.acceptance.faults --seed 1 --jobs 200`: the same plan for the same numbers, whatever the machine."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from tests.acceptance.faults.small_disks import leave_mounts

OUT = Path(__file__).resolve().parents[3] / "out" / "faults"
# what the lab has by default, but for attempts: most jobs are hit more than once here
LONG = {"INTEGUMENT_MAX_ATTEMPTS": "6", "INTEGUMENT_WORKER_CONCURRENCY": "2", "INTEGUMENT_DISK_FLOOR_BYTES": "16MiB"}
SHORT = LONG | {"INTEGUMENT_LEASE_S": "6", "INTEGUMENT_RECONCILE_S": "1", "INTEGUMENT_RERING_S": "3"}


def main() -> int:
    """0 if nothing is wrong, else 1 with what is."""
    parser = argparse.ArgumentParser(prog="python -m tests.acceptance.faults", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--faults", type=int, default=None, help="default: two for every five jobs")
    parser.add_argument("--pace", type=float, default=2.0, help="seconds per job, in the mean")
    parser.add_argument("--short", action="store_true", help="short leases, so that a run of seconds sees their end")
    parser.add_argument("--keep", action="store_true", help="print the end of every log")
    told = parser.parse_args()
    leave_mounts()  # while there is one thread
    from tests.acceptance.faults.plan import draw_plan
    from tests.acceptance.faults.run import run_faults

    faults = told.jobs * 2 // 5 if told.faults is None else told.faults
    plan = draw_plan(told.seed, told.jobs, told.pace, faults)
    with tempfile.TemporaryDirectory(prefix="itg-faults-", dir="/tmp", ignore_cleanup_errors=True) as folder:
        wrong = run_faults(plan, Path(folder), os.environ.get("PYTHONPATH", ""), SHORT if told.short else LONG, OUT)
        if wrong or told.keep:
            logs = OUT / f"{told.seed}-logs"
            logs.mkdir(parents=True, exist_ok=True)
            for log in Path(folder).glob("*.log"):
                (logs / log.name).write_bytes(log.read_bytes())
    for line in wrong:
        print(f"WRONG {line}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
