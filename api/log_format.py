"""What the API writes to stderr: lines for people, and the audit log as lines of JSON. Keys are taken out of both."""

from __future__ import annotations

import logging

from api.audit_trail import lines
from store.key_text import without_secrets


class WithoutSecrets(logging.Formatter):
    """Also of tracebacks: a key may stand in a path or an argument."""

    def format(self, record: logging.LogRecord) -> str:
        return without_secrets(super().format(record))


def configure_logging() -> None:
    """For the process that serves; tests configure their own."""
    handler = logging.StreamHandler()
    handler.setFormatter(WithoutSecrets("%(asctime)s %(levelname)s %(name)s %(message)s"))
    logging.basicConfig(level=logging.INFO, handlers=[handler])
    plain = logging.StreamHandler()
    plain.setFormatter(WithoutSecrets("%(message)s"))
    lines.addHandler(plain)
    lines.propagate = False
