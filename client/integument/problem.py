"""Refusals: RFC 9457 problem documents."""

from __future__ import annotations

from typing import Any

import httpx

from integument.answer import Answer

EXCERPT_CHARACTERS = 200


class Problem(Answer):
    """Why the server refused. `code` is stable, `detail` is a sentence with numbers."""

    type: str = "about:blank"
    title: str = ""
    status: int
    detail: str = ""
    code: str = ""
    errors: tuple[dict[str, Any], ...] = ()
    request_id: str | None = None
    retryable: bool = False


def read_problem(response: httpx.Response) -> Problem:
    """The problem in an error response; one made from status and text if a proxy answered in the server's place.

    The status line wins over the body, and a problem without a code gets `http.{status}`.
    """
    fallback = f"http.{response.status_code}"
    try:
        document = response.json()
    except ValueError:
        document = None
    if not isinstance(document, dict):
        text = " ".join(response.text.split())[:EXCERPT_CHARACTERS]
        detail = f"{response.status_code} {response.reason_phrase} {text}".strip()
        return Problem(title=response.reason_phrase, status=response.status_code, detail=detail, code=fallback)
    known = {**document, "status": response.status_code, "code": document.get("code") or fallback}
    return Problem.read(known, f"the problem {response.request.url} answered")
