"""Kombu's Redis transport, made to survive what lies in the queue.

As it comes, one entry that is no JSON, or JSON of another shape, ends the worker ("Unrecoverable error")."""

from __future__ import annotations

import logging
from queue import Empty
from typing import Any

from kombu.transport import TRANSPORT_ALIASES
from kombu.transport import redis as kombu_redis

logger = logging.getLogger(__name__)


class SturdyChannel(kombu_redis.Channel):  # type: ignore[misc]  # kombu has no types
    """Drops an entry nobody can read."""

    def _brpop_read(self, **options: Any) -> Any:
        known = set(self.qos._delivered)
        try:
            return super()._brpop_read(**options)
        except (Empty, *self.connection.connection_errors, *self.connection.channel_errors):
            raise
        except Exception:
            logger.exception("an entry of the queue cannot be read and is dropped")
            for tag in set(self.qos._delivered) - known:  # else it would hold a slot for ever
                self.basic_reject(tag, requeue=False)
            return False


class SturdyTransport(kombu_redis.Transport):  # type: ignore[misc]  # kombu has no types
    """For `redis://`, `rediss://` and `redis+socket://`."""

    Channel = SturdyChannel


def install() -> None:
    """From now on a broker URL of Redis means this transport."""
    for scheme in ("redis", "rediss"):
        TRANSPORT_ALIASES[scheme] = f"{__name__}:{SturdyTransport.__name__}"
