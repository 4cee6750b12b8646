"""A thread that does one small thing every few seconds, whatever becomes of a single time."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable

from core.errors import IntegumentError

logger = logging.getLogger(__name__)


class Periodic:
    """Acts at once when started, then every `every_s`; a database that is away costs one time, not the thread."""

    def __init__(self, name: str, act: Callable[[], object], every_s: float) -> None:
        self._name = name
        self._act = act
        self._every_s = every_s
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._loop, name=name, daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """Returns when the present act is over."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def act(self) -> None:
        """Once, now; never raises."""
        try:
            self._act()
        except IntegumentError as error:
            logger.warning("%s waits: %s", self._name, error)
        except Exception:
            logger.exception("%s stumbled and goes on", self._name)

    def _loop(self) -> None:
        while True:
            self.act()
            if self._stop.wait(self._every_s):
                return
