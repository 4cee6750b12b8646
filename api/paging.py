"""The header `Link` that leads to the next page, as the body does."""

from __future__ import annotations

from collections.abc import Iterable

from fastapi import Response

from api.schemas.link import Link


def add_next_link(response: Response, links: Iterable[Link]) -> None:
    """Repeat the `next` link of a list in the header (RFC 8288)."""
    for link in links:
        if link.rel == "next":
            response.headers["Link"] = f'<{link.href}>; rel="next"'
