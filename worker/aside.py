"""Slow work beside a heartbeat, left behind at once when the heartbeat says so."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from worker.outage import sit_out

T = TypeVar("T")


def work_aside(work: Callable[[], T], beat: Callable[[], None], look_s: float) -> T:
    """Do `work` in a thread, again while the store is away, and `beat` every `look_s`.

    What `beat` raises ends this at once: a store that hangs holds up neither a dismissal nor the stop of the worker. The thread
    is left to itself then, so `work` must be harmless when it is done in vain."""
    done: Future[T] = Future()
    left = threading.Event()

    def run() -> None:
        try:
            done.set_result(sit_out(work, left=left))
        except BaseException as error:  # noqa: BLE001 - whoever waits raises it
            done.set_exception(error)

    threading.Thread(target=run, name="aside", daemon=True).start()
    try:
        while True:
            try:
                return done.result(timeout=look_s)
            except TimeoutError:
                if done.done():  # the work itself raised it
                    raise
                beat()
    finally:
        left.set()
