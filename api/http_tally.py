"""Requests as this process counts them, written to the shared tables every few seconds: no request waits for that.

A process that is killed loses the counts of its last seconds, of requests alone; jobs are counted with their own rows."""

from __future__ import annotations

import logging
import threading

from core.errors import IntegumentError
from store.metric_family import HTTP_REQUESTS, HTTP_S, REFUSALS
from store.metrics import Metrics
from store.periodic import Periodic
from store.tally import Tally

WRITE_S = 5.0
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
NO_ROUTE = "none"
REFUSING = ("access.", "rate.", "quota.", "request.host_refused", "request.origin_refused")

logger = logging.getLogger(__name__)


class HttpTally:
    """Thread-safe; `note` never waits for the database."""

    def __init__(self, metrics: Metrics) -> None:
        self._metrics = metrics
        self._tally = Tally()
        self._lock = threading.Lock()
        self._periodic = Periodic("request counts", self._write, WRITE_S)

    def start(self) -> None:
        """Begin to write."""
        self._periodic.start()

    def stop(self) -> None:
        """Returns when all that was noted is written, if the database lets us."""
        self._periodic.stop()
        self._periodic.act()

    def note(self, method: str, route: str | None, status: int, seconds: float, code: str | None) -> None:
        """One answer. route: the template, never the path; code: of the problem it told of."""
        method = method if method in METHODS else "other"
        route = route or NO_ROUTE
        with self._lock:
            self._tally.count(HTTP_REQUESTS, method, route, str(status))
            self._tally.observe(HTTP_S, method, route, value=seconds)
            if code is not None and code.startswith(REFUSING):
                self._tally.count(REFUSALS, code)

    def _write(self) -> None:
        """Folding is the workers' round, too; without one the rows of this process alone would pile up."""
        self.flush()
        self._metrics.fold()

    def flush(self) -> None:
        """Write what was noted; what the database does not take is kept. Raises InternalError `database.unavailable`."""
        with self._lock:
            tally, self._tally = self._tally, Tally()
        try:
            self._metrics.add(tally)
        except IntegumentError:
            with self._lock:
                self._tally.absorb(tally)
            raise
