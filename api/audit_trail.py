"""From requests to the audit log: a line of JSON at once, the row of the table a moment later.

The rows of a quarter second are one transaction: an accepted job must not wait for a second one. A server killed in that moment
leaves the lines."""

from __future__ import annotations

import logging
import queue
import threading
import time

from core.errors import IntegumentError
from store.audit import Audit, AuditEntry

WRITE_S = 0.25
MAX_WAITING = 10_000  # while the database is away
REFUSALS_PER_MINUTE = 300  # whoever knocks without end shall not fill the disk

lines = logging.getLogger("integument.audit")
logger = logging.getLogger(__name__)


class AuditTrail:
    """Thread-safe; `note` never waits for the database."""

    def __init__(self, audit: Audit) -> None:
        self._audit = audit
        self._waiting: queue.Queue[AuditEntry] = queue.Queue(MAX_WAITING)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._loop, name="audit", daemon=True)
        self._lock = threading.Lock()
        self._minute = 0
        self._refusals = 0

    def start(self) -> None:
        """Begin to write rows."""
        self._thread.start()

    def stop(self) -> None:
        """Returns when all that was noted is written, if the database lets us."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()
        self.flush()

    def note(self, entry: AuditEntry) -> None:
        """What was done."""
        extra = {"event": "audit", "fields": entry.describe()}
        lines.info("%s %s: %s", entry.action, entry.subject[:200], entry.outcome, extra=extra)
        try:
            self._waiting.put_nowait(entry)
        except queue.Full:
            logger.warning("the audit log has no place for an entry; it is in the lines alone")

    def note_refusal(self, entry: AuditEntry) -> None:
        """What was refused at the gate; of very many in one minute the rest is left out, and that is said."""
        with self._lock:
            minute = int(time.monotonic() // 60)
            if minute != self._minute:
                self._minute, self._refusals = minute, 0
            self._refusals += 1
            count = self._refusals
        if count <= REFUSALS_PER_MINUTE:
            self.note(entry)
        elif count == REFUSALS_PER_MINUTE + 1:
            logger.warning("more than %d requests were refused within a minute; the rest is not noted", REFUSALS_PER_MINUTE)

    def flush(self) -> None:
        """Write what waits; what the database does not take goes on waiting."""
        entries = []
        while not self._waiting.empty():
            entries.append(self._waiting.get_nowait())
        try:
            self._audit.write(entries)
        except IntegumentError as error:
            logger.warning("%d entries of the audit log wait: %s", len(entries), error)
            for entry in entries:
                if not self._waiting.full():
                    self._waiting.put_nowait(entry)

    def _loop(self) -> None:
        while not self._stop.wait(WRITE_S):
            try:
                self.flush()
            except Exception:
                logger.exception("entries of the audit log are in the lines alone")
