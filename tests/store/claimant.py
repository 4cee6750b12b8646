"""A process that claims jobs as fast as it can: `python -m tests.store.claimant THREADS`, job ids on a line of its input.

Prints `ready`, then one line per job it won. Settings come from the environment."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor

from store.database import Database
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE


def main() -> None:
    """Wait for the job ids, then every thread goes for every job, each with a database of its own."""
    settings = Settings()
    threads = int(sys.argv[1])
    tables = [Jobs(Database(settings)) for _ in range(threads)]
    for table in tables:
        table.list(DEFAULT_WORKSPACE, limit=1)  # connected before the race
    print("ready", flush=True)
    job_ids = sys.stdin.readline().split()

    def race(table: Jobs, name: str) -> None:
        for job_id in job_ids:
            if table.claim(job_id, 1, name, 30.0) is not None:
                sys.stdout.write(f"{job_id}\n")  # in one piece: others write, too

    with ThreadPoolExecutor(threads) as pool:
        runners = [pool.submit(race, table, f"thread-{number}") for number, table in enumerate(tables)]
    sys.stdout.flush()
    for runner in runners:
        runner.result()  # what stopped one is said by our exit code


if __name__ == "__main__":
    main()
