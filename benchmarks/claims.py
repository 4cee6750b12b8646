"""What handing out a job costs with many waiting: `python -m benchmarks.claims`, on SQLite and on a PostgreSQL of its own."""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from sqlalchemy import insert, text

from benchmarks.table import print_table, thousands
from core.schema.expectation import JobQueue
from store.choice import Room
from store.database import Database
from store.jobs import Jobs
from store.records import JobRow
from store.settings import Settings
from store.workspace import WorkspaceId
from store.workspaces import Workspaces
from tests.postgres import PostgresServer

BOTH = frozenset(JobQueue)
ROOM = Room("host", BOTH, BOTH, memory_bytes=10**15, job_memory_bytes=10**10, patience_s=60.0)
CLAIMS = 200
FEW = 50  # jobs waiting in the small queue the large one is compared with


def fill(db: Database, workspaces: int, jobs: int) -> list[str]:
    """Accepted jobs, in turn for each workspace; every fourth is fast. Returns some of their ids."""
    names = [WorkspaceId(f"w{number:04}") for number in range(workspaces)]
    for name in names:
        Workspaces(db).create(name)
    table = Jobs(db)
    model = table.create(names[0], "validate", {})
    with db.session() as session:
        columns = JobRow.__table__.columns
        row = dict(session.execute(text("SELECT * FROM jobs")).mappings().one())
        row = {name: value for name, value in row.items() if name in columns}
        typed = session.get_one(JobRow, model.id)
        row |= {column.name: getattr(typed, column.name) for column in columns}
        rows = [
            {
                **row,
                "id": f"{number:036}",
                "workspace": names[number % workspaces],
                "queue": JobQueue.FAST if number % 4 == 0 else JobQueue.HEAVY,
            }
            for number in range(jobs)
        ]
        for start in range(0, len(rows), 500):
            session.execute(insert(JobRow), rows[start : start + 500])
        session.delete(typed)
    return [row["id"] for row in rows[:: max(1, jobs // 20)]]


@contextmanager
def databases(folder: Path) -> Iterator[dict[str, Callable[[], Settings]]]:
    """Makers of empty databases."""
    folder.chmod(0o755)  # initdb refuses root, so the server is somebody else's
    server_folder = folder / "pg"
    server_folder.mkdir(mode=0o755)
    server = PostgresServer(server_folder)
    server.start()
    numbers = iter(range(1000))

    def sqlite() -> Settings:
        return Settings(data_dir=folder / f"data{next(numbers)}")

    def postgresql() -> Settings:
        return Settings(data_dir=folder / "pgdata", database_url=server.new_database())

    try:
        yield {"SQLite": sqlite, "PostgreSQL": postgresql}
    finally:
        server.kill()


@dataclass(frozen=True, slots=True)
class Cost:
    """Medians in ms. cpu: of this process, without the server's; elapsed: with everything else the machine did meanwhile."""

    cpu: float
    elapsed: float

    @classmethod
    def of(cls, acts: Iterable[Callable[[], object]]) -> Cost:
        """Do each once."""
        cpu, elapsed = [], []
        for act in acts:
            began, cpu_began = time.perf_counter(), time.process_time()
            act()
            elapsed.append(1000 * (time.perf_counter() - began))
            cpu.append(1000 * (time.process_time() - cpu_began))
        return cls(statistics.median(cpu), statistics.median(elapsed))

    def against(self, base: Cost) -> str:
        """Numbers, and in brackets how many times those of the short queue."""
        return f"{self.cpu:.1f} ({self.cpu / base.cpu:.1f}), {self.elapsed:.1f} ({self.elapsed / base.elapsed:.1f})"


def measure(settings: Settings, workspaces: int, jobs: int) -> tuple[Cost, Cost, Cost]:
    """Of a claim, of a look that finds nothing that fits, and of a queue position."""
    database = Database(settings)
    with closing(database):
        database.migrate()
        some = fill(database, workspaces, jobs)
        table = Jobs(database)
        full = Room("other", BOTH, BOTH, memory_bytes=1, job_memory_bytes=10**10, patience_s=60.0)
        look = Cost.of([lambda: table.claim_next("other:1", 30.0, full)] * 20)
        place = Cost.of(partial(table.queue_position, WorkspaceId(f"w{int(job_id) % workspaces:04}"), job_id) for job_id in some)
        claim = Cost.of([lambda: table.claim_next("host:1", 30.0, ROOM)] * min(CLAIMS, jobs))
    return claim, look, place


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.claims", description=__doc__)
    parser.add_argument("--jobs", type=int, default=10_000, help="waiting jobs of the long queue")
    parser.add_argument("--workspaces", type=int, default=50)
    chosen = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name, databases(Path(name)) as makers:
        for kind, make in makers.items():
            few = measure(make(), chosen.workspaces, FEW)
            many = measure(make(), chosen.workspaces, chosen.jobs)
            for jobs, told in ((FEW, few), (chosen.jobs, many)):
                rows.append((kind, thousands(jobs), *(mine.against(base) for mine, base in zip(told, few, strict=True))))
    acts = ("claim", "look in vain", "queue position")
    head = ("database", "jobs waiting", *(f"{act}: CPU ms (times), elapsed ms (times)" for act in acts))
    print_table(f"Handing out jobs, {chosen.workspaces} workspaces", head, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
