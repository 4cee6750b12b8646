"""The version of the server, under the name the routes know."""

from __future__ import annotations

from store.version import SERVER_VERSION

__all__ = ["SERVER_VERSION"]
