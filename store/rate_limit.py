"""How many requests a workspace may send: a token bucket per workspace in Valkey, shared by all API processes."""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from urllib.parse import parse_qs, unquote, urlsplit

import redis
from redis.backoff import NoBackoff
from redis.retry import Retry

from store.workspace import WorkspaceId

TIMEOUT_S = 0.25
PAUSE_S = 5.0  # a Valkey that does not answer is not asked again for so long
_KEY = "integument:rate:"
# one step, so that of any number of processes none takes a token twice; Valkey's clock is the only one unless one is given
_TAKE = """
local rate, burst, now = tonumber(ARGV[1]), tonumber(ARGV[2]), tonumber(ARGV[3])
if not now then
  local time = redis.call('TIME')
  now = tonumber(time[1]) + tonumber(time[2]) / 1000000
end
local held = redis.call('HMGET', KEYS[1], 'tokens', 'at')
local tokens = tonumber(held[1]) or burst
tokens = math.min(burst, tokens + math.max(0, now - (tonumber(held[2]) or now)) * rate)
local allowed = 0
if tokens >= 1 then
  tokens = tokens - 1
  allowed = 1
end
redis.call('HSET', KEYS[1], 'tokens', string.format('%.6f', tokens), 'at', string.format('%.6f', now))
redis.call('PEXPIRE', KEYS[1], math.ceil(burst / rate * 1000) + 1000)
return {allowed, string.format('%.6f', tokens)}
"""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Allowance:
    """What is left of a bucket of `burst` requests that fills by `per_s`."""

    allowed: bool
    burst: int
    per_s: float
    tokens: float

    @property
    def remaining(self) -> int:
        """Requests that may follow at once."""
        return int(self.tokens)

    @property
    def window_s(self) -> int:
        """In so many seconds an empty bucket is full."""
        return math.ceil(self.burst / self.per_s)

    @property
    def reset_s(self) -> int:
        """In so many seconds it is full again."""
        return math.ceil((self.burst - self.tokens) / self.per_s)

    @property
    def retry_after_s(self) -> int:
        """In so many seconds, one at least, there is a token again."""
        return max(1, math.ceil((1.0 - self.tokens) / self.per_s))


class RateLimiter:
    """Thread-safe; connects when first asked. A Valkey that is away limits nobody: it may lose everything, requests go on.

    now_s: seconds of another clock than Valkey's, for tests; all processes would have to share it."""

    def __init__(self, broker_url: str, per_s: float, burst: int, now_s: Callable[[], float] | None = None) -> None:
        self._per_s = per_s
        self._burst = burst
        self._now_s = now_s
        self._client = _connect(broker_url)
        self._take = self._client.register_script(_TAKE)
        self._quiet_until = -math.inf

    def take(self, workspace: WorkspaceId) -> Allowance | None:
        """One request more of that workspace; None where nothing is counted."""
        if self._per_s <= 0 or time.monotonic() < self._quiet_until:
            return None
        try:
            now = "" if self._now_s is None else self._now_s()
            allowed, tokens = self._take(keys=[_KEY + workspace], args=[self._per_s, self._burst, now])
        except redis.RedisError as error:
            self._quiet_until = time.monotonic() + PAUSE_S
            _log.warning("requests are not counted for %.0f s, Valkey does not answer: %s", PAUSE_S, error)
            return None
        return Allowance(bool(allowed), self._burst, self._per_s, float(tokens))

    def close(self) -> None:
        """Close the connections."""
        self._client.close()


def _connect(url: str) -> redis.Redis:
    patience = {"socket_timeout": TIMEOUT_S, "socket_connect_timeout": TIMEOUT_S, "retry": Retry(NoBackoff(), 0)}
    if not url.startswith("redis+socket://"):
        return redis.Redis.from_url(url, **patience)
    parts = urlsplit(url)  # as kombu writes it
    number = parse_qs(parts.query).get("virtual_host", ["0"])[0].strip("/") or "0"
    return redis.Redis(unix_socket_path=unquote(parts.path), password=parts.password, db=int(number), **patience)
