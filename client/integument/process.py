"""Processes the server offers."""

from __future__ import annotations

from typing import Any

from integument.answer import Answer


class Process(Answer):
    """An OGC process description; inputs and outputs are there only when asked for by id."""

    id: str
    version: str = ""
    title: str = ""
    description: str = ""
    keywords: tuple[str, ...] = ()
    inputs: dict[str, Any] = {}
    outputs: dict[str, Any] = {}
