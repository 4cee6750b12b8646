"""The tables about the workers themselves, and of what everybody counts. Rows stay inside `store`."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import BigInteger, Integer, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from store.instant import Instant
from store.record import Json, Record


class LeaderRow(Record):
    """Which worker does what one is enough for, and until when it may."""

    __tablename__ = "leaders"

    office: Mapped[str] = mapped_column(String(32), primary_key=True)
    holder: Mapped[str] = mapped_column(Text)
    until: Mapped[datetime] = mapped_column(Instant)


class WorkerRow(Record):
    """A worker process that gives word every few seconds; one that stops in good order takes its row along."""

    __tablename__ = "workers"

    name: Mapped[str] = mapped_column(String(300), primary_key=True)
    host: Mapped[str] = mapped_column(String(255))
    version: Mapped[str] = mapped_column(String(64))
    concurrency: Mapped[int]
    memory_bytes: Mapped[int] = mapped_column(BigInteger)
    disk_free_bytes: Mapped[int] = mapped_column(BigInteger)
    draining: Mapped[bool]
    queues: Mapped[str] = mapped_column(String(64), server_default=text("'fast,heavy'"))
    started_at: Mapped[datetime] = mapped_column(Instant)
    seen_at: Mapped[datetime] = mapped_column(Instant)


class TallyRow(Record):
    """What was just counted: a row of its own, so that nobody who counts waits for another; folded into `metric_totals`."""

    __tablename__ = "metric_tallies"

    id: Mapped[int] = mapped_column(BigInteger().with_variant(Integer, "sqlite"), primary_key=True)
    cells: Mapped[list[list[Any]]] = mapped_column(Json)


class MetricTotalRow(Record):
    """What was counted since the tables were made; `cell` is empty for a counter, `sum` or a bucket's number in a histogram."""

    __tablename__ = "metric_totals"

    family: Mapped[str] = mapped_column(String(64), primary_key=True)
    labels: Mapped[str] = mapped_column(String(400), primary_key=True)
    cell: Mapped[str] = mapped_column(String(8), primary_key=True)
    value: Mapped[float]
