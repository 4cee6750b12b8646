"""What all tables have in common."""

from __future__ import annotations

from sqlalchemy import JSON, MetaData
from sqlalchemy.orm import DeclarativeBase

Json = JSON(none_as_null=True)  # text on both databases: JSONB would reorder keys, and inputs must come back as they came


class Record(DeclarativeBase):
    """Base of all tables; constraints have names, so migrations can speak of them."""

    metadata = MetaData(
        naming_convention={
            "ix": "ix_%(table_name)s_%(column_0_N_name)s",
            "ck": "ck_%(table_name)s_%(constraint_name)s",
            "fk": "fk_%(table_name)s_%(column_0_N_name)s",
            "pk": "pk_%(table_name)s",
        }
    )
