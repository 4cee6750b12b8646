"""Sends one callback, once."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import httpcore
import httpx

from core.errors import InputError
from store.callback import Callback
from store.callback_secret import workspace_secret
from store.receivers import Receivers
from worker.checked_network import CheckedNetwork, Resolve, resolve
from worker.signature import signature_headers

TIMEOUT_S = 15.0
GONE = 410


@dataclass(frozen=True, slots=True)
class Answer:
    """What became of one attempt; `status` is None if nobody answered, `error` is for the subscriber's eyes."""

    status: int | None
    error: str

    @property
    def is_success(self) -> bool:
        """2xx alone: a redirect is not followed, so nobody took the message."""
        return self.status is not None and 200 <= self.status < 300

    @property
    def is_final(self) -> bool:
        """The receiver wants no more of it."""
        return self.status == GONE


class CallbackSender:
    """Thread-safe. httpcore follows no redirects and reads no proxies from the environment; every request has a connection
    of its own, so no answer of one receiver is read as another's."""

    def __init__(
        self, receivers: Receivers, secrets: Sequence[str], *, timeout_s: float = TIMEOUT_S, resolve: Resolve = resolve
    ) -> None:
        self._receivers = receivers
        self._secrets = tuple(secrets)
        self._timeout_s = timeout_s
        self._resolve = resolve
        self._tls = httpx.create_ssl_context()  # SSL_CERT_FILE, else certifi

    def send(self, callback: Callback) -> Answer:
        """POST the body; never raises for anything a receiver can do."""
        body = callback.body.encode()
        secrets = [workspace_secret(secret, callback.workspace) for secret in self._secrets]
        headers: dict[bytes | str, bytes | str] = {
            "content-type": "application/json",
            "user-agent": "Integument",
            "connection": "close",
        }
        headers.update(signature_headers(secrets, callback.id, int(time.time()), body))
        try:
            self._receivers.require_uri(callback.uri)  # once more: the operator may have changed his mind
            network = CheckedNetwork(self._receivers, self._timeout_s, self._resolve)
            with (
                httpcore.ConnectionPool(ssl_context=self._tls, network_backend=network, http2=False) as pool,
                pool.stream("POST", callback.uri, headers=headers, content=body) as response,  # what it says is not read
            ):
                status = int(response.status)
        except InputError as error:
            return Answer(None, error.message)
        except httpcore.TimeoutException:
            return Answer(None, f"no answer within {self._timeout_s:g} s")
        except (httpcore.NetworkError, httpcore.ProtocolError, httpcore.UnsupportedProtocol) as error:
            return Answer(None, f"{type(error).__name__}: {error}"[:200])
        return Answer(status, f"answered {status}")
