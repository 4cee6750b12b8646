"""Cursors."""

from __future__ import annotations

from datetime import UTC, datetime
from uuid import UUID

from hypothesis import given
from hypothesis import strategies as st

from store.page import from_cursor, to_cursor


@given(moment=st.datetimes(timezones=st.just(UTC)), number=st.uuids(version=4))
def test_a_cursor_leads_back_to_its_place(moment: datetime, number: UUID) -> None:
    cursor = to_cursor(moment, str(number))
    assert from_cursor(cursor) == (moment, str(number))
    assert cursor.replace("-", "").replace("_", "").isalnum()  # fits a URL as it is
