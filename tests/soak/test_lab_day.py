"""Twenty-four hours of work and sweeps: after the longest time anything is kept, nothing grows any more."""

from __future__ import annotations

from pathlib import Path

import pytest

from store.database import WAL_BYTES, Database
from tests.postgres import PostgresServer
from tests.soak.lab_day import Clock, LabDay, Stock, short_memory
from tests.valkey import ValkeyServer

HOURS = 24
STEADY = 6  # everything is kept for three hours, files for one more
BUSY = 5  # jobs, and as many uploads, every ten minutes
SLACK = 1.10
BIGGEST_SPARE = 1.6  # a database file keeps pages it will soon use again


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(Database, "now", clock)
    return clock


def a_day(
    request: pytest.FixtureRequest, kind: str, per_step: int, clock: Clock, folder: Path, valkey: ValkeyServer
) -> list[Stock]:
    server: PostgresServer | None = request.getfixturevalue("postgres") if kind == "postgresql" else None
    data = folder / "data"
    data.mkdir()
    day = LabDay(short_memory(data, server.new_database() if server else "", valkey.url), clock, per_step)
    try:
        return list(day.run(HOURS))
    finally:
        day.close()


def require_steady(day: list[Stock]) -> None:
    early, late = day[STEADY - 1 : 15], day[15:]
    for name in day[-1].rows:
        most = max(stock.rows[name] for stock in early)
        assert max(stock.rows[name] for stock in late) <= most * SLACK + 3, name
    for member, slack in (("blobs", SLACK), ("blob_bytes", SLACK), ("other_files", SLACK), ("database_bytes", BIGGEST_SPARE)):
        most = max(getattr(stock, member) for stock in early)
        assert max(getattr(stock, member) for stock in late) <= most * slack, member
    assert max(stock.log_bytes for stock in day) <= WAL_BYTES
    assert {stock.bells for stock in day} == {0}
    assert day[-1].broker_bytes <= max(stock.broker_bytes for stock in early) * 1.2


def show(day: list[Stock]) -> None:
    """The table of docs/operations.md."""
    titles = ("hour", "jobs so far", "rows: jobs", "events", "all", "files", "MB", "database MB", "log MB", "broker kB")
    print("\n| " + " | ".join(titles) + " |\n" + "|---" * len(titles) + "|")
    for stock in (stock for stock in day if stock.hour in (1, 3, 6, 12, 18, 24)):
        rows = (stock.rows["jobs"], stock.rows["job_events"], sum(stock.rows.values()))
        sizes = (stock.blob_bytes / 1e6, stock.database_bytes / 1e6, stock.log_bytes / 1e6)
        cells = (stock.hour, stock.jobs_so_far, *rows, stock.blobs + stock.other_files)
        print("| " + " | ".join([*map(str, cells), *(f"{size:.2f}" for size in sizes), f"{stock.broker_bytes / 1e3:.0f}"]) + " |")


@pytest.mark.timeout(900)
def test_a_small_day_leaves_no_more_than_its_last_hours(
    request: pytest.FixtureRequest, clock: Clock, tmp_path: Path, valkey: ValkeyServer
) -> None:
    day = a_day(request, "sqlite", 1, clock, tmp_path, valkey)
    require_steady(day)
    assert day[-1].jobs_so_far == 144
    assert 0 < day[-1].rows["jobs"] <= 30


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_a_busy_day_leaves_no_more_than_its_last_hours(
    kind: str, request: pytest.FixtureRequest, clock: Clock, tmp_path: Path, valkey: ValkeyServer
) -> None:
    day = a_day(request, kind, BUSY, clock, tmp_path, valkey)
    show(day)
    require_steady(day)
    assert day[-1].jobs_so_far == HOURS * 6 * BUSY
