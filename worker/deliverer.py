"""Sends callbacks, again and again until they are taken (Standard Webhooks); at least once, never by two at a time."""

from __future__ import annotations

import logging
import random
import threading
import time
from collections.abc import Callable, Sequence

from core.errors import IntegumentError
from store.callback import Callback, CallbackState
from store.callbacks import Callbacks
from store.receivers import host_of
from worker.callback_sender import Answer, CallbackSender

logger = logging.getLogger(__name__)

HOUR_S = 3600.0
DELAYS_S = (5.0, 300.0, 1800.0, 2 * HOUR_S, 5 * HOUR_S, 10 * HOUR_S, 14 * HOUR_S, 20 * HOUR_S, 24 * HOUR_S)
"""Between attempts, so there are ten; what failed together does not come back together: see JITTER."""

JITTER = 0.1  # of each delay, added at random
THREADS = 4
POLL_S = 1.0
LEASE_S = 90.0  # above what one attempt takes, with a slow look-up of the name


def add_jitter(delay_s: float) -> float:
    """Up to a tenth more."""
    return delay_s * (1 + JITTER * random.random())  # noqa: S311 - nothing to guess


class Deliverer:
    """Threads of the worker; any number of workers may deliver at once."""

    def __init__(
        self,
        callbacks: Callbacks,
        sender: CallbackSender,
        *,
        delays_s: Sequence[float] = DELAYS_S,
        jitter: Callable[[float], float] = add_jitter,
        lease_s: float = LEASE_S,
        poll_s: float = POLL_S,
        threads: int = THREADS,
    ) -> None:
        self._callbacks = callbacks
        self._sender = sender
        self._delays_s = tuple(delays_s)
        self._jitter = jitter
        self._lease_s = lease_s
        self._poll_s = poll_s
        self._stop = threading.Event()
        self._threads = [threading.Thread(target=self._loop, name=f"deliverer-{n}", daemon=True) for n in range(threads)]

    def start(self) -> None:
        """Begin with a look at once."""
        for thread in self._threads:
            thread.start()

    def let_go(self) -> None:
        """Begin no more deliveries."""
        self._stop.set()

    def stop(self, patience_s: float) -> None:
        """Wait for those under way; what is not over then is sent again by another worker when its lease has run out."""
        self._stop.set()
        deadline = time.monotonic() + patience_s
        for thread in self._threads:
            if thread.is_alive():
                thread.join(max(0.0, deadline - time.monotonic()))

    def deliver_next(self) -> bool:
        """Send one that is due, if there is one. Raises InternalError `database.unavailable`."""
        if not self._callbacks.any_due():
            return False
        callback = self._callbacks.claim(self._lease_s, len(self._delays_s) + 1)
        if callback is None:
            return False
        self._settle(callback, self._sender.send(callback))
        return True

    def _settle(self, callback: Callback, answer: Answer) -> None:
        if answer.is_success and answer.status is not None:
            self._callbacks.deliver(callback, answer.status)
        elif answer.is_final or callback.attempts > len(self._delays_s):
            if self._callbacks.bury(callback, answer.status, answer.error):
                logger.warning(
                    "job %s: callback %s (%s) to %s is given up at attempt %d: %s; %d callbacks are dead",
                    *(callback.job_id, callback.id, callback.event, host_of(callback.uri), callback.attempts, answer.error),
                    self._callbacks.count()[CallbackState.DEAD],
                )
        else:
            wait_s = self._jitter(self._delays_s[callback.attempts - 1])
            if self._callbacks.put_off(callback, answer.status, answer.error, wait_s):
                logger.info(
                    "job %s: callback %s to %s failed: %s; again in %.0f s",
                    *(callback.job_id, callback.id, host_of(callback.uri), answer.error, wait_s),
                )

    def _loop(self) -> None:
        while not self._stop.is_set():
            try:
                if self.deliver_next():
                    continue
            except IntegumentError as error:
                logger.warning("callbacks wait: %s", error)
            except Exception:
                logger.exception("a deliverer stumbled and goes on")
            self._stop.wait(self._poll_s)
