"""What our own code reads out of headers, each by itself: faster than a whole request, so more is tried."""

from __future__ import annotations

from contextlib import suppress

from starlette.requests import Request

from api.downloads import content_disposition, requested_span
from api.negotiation import prefers
from api.preferences import read_preferences
from api.tus import checksum_of, metadata_of, number_of
from api.upload_form import plain_name
from core.errors import InputError, StateError


def read_headers(data: bytes) -> None:
    """The same text as every header we read. Raises AssertionError if a file name could break out of its header."""
    import asyncio

    text = data.decode("latin-1")
    names = (b"upload-metadata", b"upload-checksum", b"upload-length")
    request = Request({"type": "http", "headers": [(name, data) for name in names]})
    read_preferences([text])
    prefers(text, "text/html", "application/json")
    for read in (metadata_of, lambda request: number_of(request, "upload-length"), lambda r: asyncio.run(checksum_of(r))):
        with suppress(InputError):
            read(request)
    with suppress(StateError):
        span = requested_span(text, 1000)
        assert span is None or 0 <= span[0] < span[1] <= 1000
    shown = content_disposition(plain_name(text))
    assert shown.isascii()
    assert shown.isprintable()
    assert shown.count('"') == 2


SEEDS = (
    b"bytes=0-99",
    b"bytes=-5",
    b"filename c2tpbi5zdGw=,unit bW0=",
    b"sha1 2jmj7l5rSw0yVb/vlWAYkK/YBwk=",
    b"respond-async, wait=10",
    b"text/html;q=0.9, */*;q=0.1",
    b'..\\..\\"skin\x00".stl',
)
