"""Which one of many workers does what one is enough for: whoever holds the row's lease, by the clock of the database.

A lease and not a lock of the connection: a leader that is paused, or cut off, loses it all the same."""

from __future__ import annotations

from datetime import timedelta

from sqlalchemy import or_, update
from sqlalchemy.exc import IntegrityError

from store.crew_records import LeaderRow
from store.database import Database


class Leadership:
    """One candidate for one office."""

    def __init__(self, db: Database, office: str, candidate: str, lease_s: float) -> None:
        self._db = db
        self._office = office
        self._candidate = candidate
        self._lease_s = lease_s

    def campaign(self) -> bool:
        """Whether this candidate leads for the next `lease_s`: it did before, or nobody does."""
        with self._db.session() as session:
            now = self._db.now(session)
            vacant = or_(LeaderRow.holder == self._candidate, LeaderRow.until < now)
            until = now + timedelta(seconds=self._lease_s)
            taken = session.scalars(
                update(LeaderRow)
                .where(LeaderRow.office == self._office, vacant)
                .values(holder=self._candidate, until=until)
                .returning(LeaderRow.office)
            ).one_or_none()
            if taken is not None:
                return True
            if session.get(LeaderRow, self._office) is not None:
                return False
        try:
            with self._db.session() as session:
                session.add(LeaderRow(office=self._office, holder=self._candidate, until=until))
        except IntegrityError:  # another was quicker
            return False
        return True

    def resign(self) -> None:
        """Let another lead at once; nothing if this candidate does not lead."""
        with self._db.session() as session:
            mine = (LeaderRow.office == self._office, LeaderRow.holder == self._candidate)
            session.execute(update(LeaderRow).where(*mine).values(holder="", until=self._db.now(session)))
