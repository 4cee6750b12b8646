"""HTTP with the patience a lab network needs: errors mapped, transient ones tried again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from ipaddress import ip_address
from typing import Any, TypeVar
from urllib.parse import urlsplit

import httpx

from integument.api_key import authorization
from integument.backoff import Backoff
from integument.errors import ArgumentError, ProblemError, ServerError, ServerUnreachableError
from integument.problem import read_problem
from integument.retry_after import read_retry_after_s
from integument.tls import tls_context

T = TypeVar("T")
CONNECT_TIMEOUT_S = 10.0
# these end before a byte of the request is sent
UNSENT = (httpx.ConnectError, httpx.ConnectTimeout, httpx.PoolTimeout)


class Transport:
    """One server, one pool of connections."""

    def __init__(self, url: str, *, api_key: str | None, timeout_s: float, retries: int, first_pause_s: float) -> None:
        """Raises: ArgumentError for an address or key that is none."""
        self.url = normalise_url(url)
        self._retries = retries
        self.first_pause_s = first_pause_s
        self._timeout_s = timeout_s
        self._http = httpx.Client(
            base_url=self.url,
            timeout=self._timeout(timeout_s),
            headers={"User-Agent": f"integument/{_own_version()}", **authorization(api_key)},
            verify=tls_context(),
            trust_env=not _is_loopback(self.url),  # a proxy cannot reach this machine's own loopback
        )

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def backoff(self) -> Backoff:
        """A fresh count of failures."""
        return Backoff(self._retries, self.first_pause_s)

    def request(
        self, method: str, path: str, *, repeatable: bool = True, read_timeout_s: float | None = None, **arguments: Any
    ) -> httpx.Response:
        """The whole answer, a 2xx.

        repeatable: the request may reach the server twice without harm.
        Raises: ProblemError, ServerUnreachableError.
        """
        return self.persist(lambda: self.attempt(method, path, read_timeout_s, **arguments), repeatable=repeatable)

    def persist(self, attempt: Callable[[], T], *, repeatable: bool = True) -> T:
        """Run `attempt` until it succeeds or its error is final."""
        backoff = self.backoff()
        while True:
            try:
                return attempt()
            except ServerError as error:
                backoff.pause(error, repeatable=repeatable)

    @contextmanager
    def stream(
        self, method: str, path: str, *, headers: Mapping[str, str], read_timeout_s: float | None = None
    ) -> Iterator[httpx.Response]:
        """One attempt; the body is read inside the block, where errors are mapped too. 416 is handed out, not raised.

        A server may send a download on to its object store; our key stays behind, httpx takes it to no other host.
        """
        timeout = self._timeout(read_timeout_s or self._timeout_s)
        sent = self._http.stream(method, path, headers=dict(headers), timeout=timeout, follow_redirects=True)
        with self._mapped_errors(), sent as response:
            if response.is_error and response.status_code != httpx.codes.REQUESTED_RANGE_NOT_SATISFIABLE:
                response.read()
                raise _refusal(response)
            yield response

    def attempt(self, method: str, path: str, read_timeout_s: float | None = None, **arguments: Any) -> httpx.Response:
        """As `request`, but once."""
        timeout = self._timeout(read_timeout_s or self._timeout_s)
        with self._mapped_errors():
            response = self._http.request(method, path, timeout=timeout, **arguments)
        if not response.is_success:
            raise _refusal(response)
        return response

    @contextmanager
    def _mapped_errors(self) -> Iterator[None]:
        try:
            yield
        except (httpx.TransportError, httpx.DecodingError) as error:
            reason = str(error) or type(error).__name__
            raise ServerUnreachableError(self.url, reason, untouched=isinstance(error, UNSENT)) from error

    @staticmethod
    def _timeout(read_s: float) -> httpx.Timeout:
        return httpx.Timeout(read_s, connect=min(CONNECT_TIMEOUT_S, read_s))


def normalise_url(url: str) -> str:
    """The server's root: no trailing slash, no `/v1`.

    Raises: ArgumentError if it is no http(s) address.
    """
    root = url.strip().rstrip("/").removesuffix("/v1")
    parts = urlsplit(root)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ArgumentError(f"'{url}' is no server address; one looks like http://127.0.0.1:8000")
    return root


def _is_loopback(url: str) -> bool:
    host = urlsplit(url).hostname or ""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost" or host.endswith(".localhost")


def _refusal(response: httpx.Response) -> ProblemError:
    return ProblemError(read_problem(response), retry_after_s=read_retry_after_s(response.headers.get("retry-after")))


def _own_version() -> str:
    try:
        return version("integument")
    except PackageNotFoundError:
        return "unknown"
