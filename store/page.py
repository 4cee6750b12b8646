"""One page of a listing, newest first, and the opaque cursor that leads to the next."""

from __future__ import annotations

import base64
import binascii
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Generic, TypeVar

from core.errors import InputError

Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class Page(Generic[Item]):
    """`next` is None on the last page."""

    items: tuple[Item, ...]
    next: str | None


def to_cursor(created_at: datetime, identifier: str) -> str:
    """The place after the row made at `created_at`."""
    return base64.urlsafe_b64encode(f"{created_at.isoformat()} {identifier}".encode()).decode().rstrip("=")


def from_cursor(cursor: str) -> tuple[datetime, str]:
    """Raises InputError `cursor.invalid` unless `to_cursor` made it."""
    try:
        told = base64.b64decode(cursor + "=" * (-len(cursor) % 4), altchars=b"-_", validate=True).decode("ascii")
        moment, _, identifier = told.partition(" ")
        created_at = datetime.fromisoformat(moment)
    except (ValueError, binascii.Error):
        created_at = None
    if (
        created_at is None
        or created_at.utcoffset() != timedelta(0)
        or not 0 < len(identifier) <= 36
        or not identifier.isprintable()
    ):
        raise InputError("cursor.invalid", "the cursor is none of those this server hands out; leave it out to start over")
    return created_at, identifier
