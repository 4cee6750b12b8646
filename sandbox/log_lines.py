"""What our processes write to stderr: a line of JSON for machines, a line of text on a terminal."""

from __future__ import annotations

import json
import logging
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from datetime import UTC, datetime
from types import TracebackType
from typing import IO, Any

MAX_MESSAGE = 16_000  # characters; a line must fit into what collects it
LOG_FORMAT = "INTEGUMENT_LOG_FORMAT"  # the variable; it is no secret, so the nursery may know it
_UNPRINTABLE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]")  # not tab and line feed: tracebacks
FIELDS = "fields"  # of a record: what `logger.info(..., extra={"event": ..., "fields": {...}})` adds to the line

Redact = Callable[[str], str]
_context: ContextVar[Mapping[str, Any] | None] = ContextVar("log_context", default=None)


@contextmanager
def log_context(**fields: Any) -> Iterator[None]:
    """Every line of this thread or task carries these, such as job_id, attempt, workspace, worker, stage, request_id."""
    token = _context.set({**(_context.get() or {}), **fields})
    try:
        yield
    finally:
        _context.reset(token)


def add_log_context(**fields: Any) -> None:
    """From here on, to the end of the `log_context` around it."""
    _context.set({**(_context.get() or {}), **fields})


class JsonLines(logging.Formatter):
    """ts, level, event (a name that stays, else the logger's), message, and what is known of request, job and worker."""

    def __init__(self, redact: Redact) -> None:
        super().__init__()
        self._redact = redact

    def format(self, record: logging.LogRecord) -> str:
        """One line, whatever the message holds; secrets are taken out of all of it."""
        line: dict[str, Any] = {
            "ts": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z"),
            "level": record.levelname.lower(),
            "event": getattr(record, "event", record.name),
            "logger": record.name,
            "message": record.getMessage()[:MAX_MESSAGE],
            **(_context.get() or {}),
            **getattr(record, FIELDS, {}),
        }
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)[-MAX_MESSAGE:]
        return self._redact(json.dumps(line, default=str))


class TextLines(logging.Formatter):
    """For people; what is known of request and job follows the message."""

    def __init__(self, redact: Redact) -> None:
        super().__init__("%(asctime)s %(levelname)s %(name)s: %(message)s")
        self._redact = redact

    def formatMessage(self, record: logging.LogRecord) -> str:
        """The line without traceback."""
        known = " ".join(f"{name}={value}" for name, value in (_context.get() or {}).items())
        return super().formatMessage(record) + (f" [{known}]" if known else "")

    def format(self, record: logging.LogRecord) -> str:
        """The line, secrets taken out of it and of the traceback; a terminal gets no commands out of a user's file or name."""
        return _UNPRINTABLE.sub(lambda found: ascii(found[0])[1:-1], self._redact(super().format(record)))


def configure_logging(form: str, redact: Redact, stream: IO[str] | None = None) -> None:
    """For the main program of a process; `form`: `json`, `text`, or `auto`: text on a terminal."""
    target = stream or sys.stderr
    is_text = form == "text" or (form == "auto" and target.isatty())
    handler = logging.StreamHandler(target)
    handler.setFormatter(TextLines(redact) if is_text else JsonLines(redact))
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)
    logging.captureWarnings(True)
    logging.getLogger("alembic.runtime.plugins").setLevel(logging.WARNING)  # lists itself whenever it is loaded
    logging.getLogger("alembic.runtime.migration").addFilter(_is_no_look_at_tables)
    sys.excepthook = _log_uncaught


def _is_no_look_at_tables(record: logging.LogRecord) -> bool:
    """Alembic says twice how it would migrate whenever the tables' version is asked for, as every readiness probe does."""
    return not str(record.msg).startswith(("Context impl", "Will assume"))


def _log_uncaught(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)
        return
    logging.getLogger("uncaught").critical("%s ends the process", kind.__name__, exc_info=(kind, error, trace))
