"""The base of all answers: OGC writes camelCase, our code does not."""

from __future__ import annotations

from pydantic import ConfigDict

from core.schema.model import FrozenModel


class Document(FrozenModel):
    """Fields have Python names inside and OGC's names outside."""

    model_config = ConfigDict(serialize_by_alias=True, validate_by_name=True, validate_by_alias=True)
