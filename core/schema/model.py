"""The base of every schema: frozen, and an unknown key is an error, never ignored."""

from pydantic import BaseModel, ConfigDict


class FrozenModel(BaseModel):
    """Immutable, refuses unknown keys and the non-finite numbers that JSON readers let through."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
