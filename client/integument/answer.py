"""The base of everything read from a server."""

from __future__ import annotations

from typing import Any, Self

import httpx
from pydantic import BaseModel, ConfigDict, ValidationError

from integument.errors import ReplyError


class Answer(BaseModel):
    """Frozen; keys this client does not know are kept, so a newer server does not break an older client."""

    model_config = ConfigDict(frozen=True, extra="allow", validate_by_name=True, validate_by_alias=True)

    @classmethod
    def read(cls, document: object, what: str) -> Self:
        """Raises: ReplyError naming `what` was asked for and the first thing that is wrong with it."""
        try:
            return cls.model_validate(document)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            place = ".".join(str(part) for part in first["loc"]) or "the document"
            raise ReplyError(f"cannot read {what}: {place}: {first['msg']}") from error

    def as_json(self) -> dict[str, Any]:
        """The document as the server wrote it, names included."""
        return self.model_dump(mode="json", by_alias=True, exclude_unset=True)


def read_json(response: httpx.Response) -> Any:
    """Raises: ReplyError if the body is no JSON, as when something else listens at the address."""
    try:
        return response.json()
    except ValueError as error:
        kind = response.headers.get("content-type", "no content type")
        raise ReplyError(f"{response.request.url} answered {response.status_code} with {kind}, not JSON") from error
