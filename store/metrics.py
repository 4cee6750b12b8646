"""The tables of what was counted. Counting adds a row and waits for nobody; workers fold the rows into totals now and then.

A reader adds both up in one snapshot, so the numbers are exact at any moment and the same whichever process is asked."""

from __future__ import annotations

from collections.abc import Mapping

from sqlalchemy import delete, select
from sqlalchemy.dialects.postgresql import insert as insert_postgres
from sqlalchemy.dialects.sqlite import insert as insert_sqlite
from sqlalchemy.orm import Session

from store.crew_records import MetricTotalRow, TallyRow
from store.database import Database
from store.tally import Cell, Tally, labels_of, labels_text, merge, read_cells

FOLD_ROWS = 1000  # of one transaction


class Metrics:
    """Thread-safe."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def add(self, tally: Tally) -> None:
        """In a transaction of its own."""
        if tally:
            with self._db.session() as session:
                note(session, tally)

    def fold(self) -> int:
        """Move counted rows into the totals; returns how many. Any number of processes may do so at once."""
        folded = 0
        while (rows := self._fold_some()) > 0:
            folded += rows
            if rows < FOLD_ROWS:
                break
        return folded

    def read(self) -> Mapping[Cell, float]:
        """All cells. Costs as much as there are series and unfolded rows, however many jobs there were."""
        with self._db.reading() as session:
            if not self._db.is_sqlite:  # a row must not move between the two looks
                session.connection(execution_options={"isolation_level": "REPEATABLE READ"})
            totals = _totals(session)
            rows = session.scalars(select(TallyRow.cells)).all()
        changes = merge(totals, (cell for cells in rows for cell in read_cells(cells)))
        return totals | {cell: totals.get(cell, 0.0) + value for cell, value in changes.items()}

    def _fold_some(self) -> int:
        with self._db.session() as session:
            query = select(TallyRow.id, TallyRow.cells).order_by(TallyRow.id).limit(FOLD_ROWS)
            rows = session.execute(query.with_for_update(skip_locked=True)).all()
            if not rows:
                return 0
            changes = merge(_totals(session), (cell for _, cells in rows for cell in read_cells(cells)))
            insert = insert_sqlite if self._db.is_sqlite else insert_postgres
            values = [
                {"family": cell.family, "labels": labels_text(cell.labels), "cell": cell.cell, "value": value}
                for cell, value in changes.items()
            ]
            values.sort(key=lambda value: (value["family"], value["labels"], value["cell"]))  # two at once never wait in a ring
            upsert = insert(MetricTotalRow)
            upsert = upsert.on_conflict_do_update(
                index_elements=[MetricTotalRow.family, MetricTotalRow.labels, MetricTotalRow.cell],
                set_={"value": MetricTotalRow.value + upsert.excluded.value},
            )
            session.execute(upsert, values)
            session.execute(delete(TallyRow).where(TallyRow.id.in_([row_id for row_id, _ in rows])))
            return len(rows)


def note(session: Session, tally: Tally) -> None:
    """Count within the transaction of what is counted: one is never there without the other."""
    session.add(TallyRow(cells=tally.describe()))


def _totals(session: Session) -> dict[Cell, float]:
    rows = session.execute(select(MetricTotalRow.family, MetricTotalRow.labels, MetricTotalRow.cell, MetricTotalRow.value))
    return {Cell(family, labels_of(labels), cell): float(value) for family, labels, cell, value in rows}
