"""The outputs of a finished job."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from integument.answer import Answer
from integument.errors import ReplyError


class Output(Answer):
    """A link to one output; `href` may be used as an input of the next job. rel: where it stands in a job, not in its results."""

    href: str
    rel: str | None = None
    type: str | None = None
    title: str | None = None


@dataclass(frozen=True, slots=True)
class Results:
    """The OGC results document, links apart from values."""

    outputs: Mapping[str, Output]
    values: Mapping[str, Any]

    @classmethod
    def read(cls, document: object) -> Results:
        """Raises: ReplyError if the document is no JSON object."""
        if not isinstance(document, dict):
            raise ReplyError("cannot read the results: not a JSON object")
        links = {name: value for name, value in document.items() if isinstance(value, dict) and "href" in value}
        outputs = {name: Output.read(value, f"the result {name}") for name, value in links.items()}
        return cls(outputs, {name: value for name, value in document.items() if name not in links})
