"""Where an attempt is: a span, a field of its log lines and a line at the end for each stage."""

from __future__ import annotations

import logging
import time
from contextlib import ExitStack

from sandbox.log_lines import add_log_context
from store.job_tally import stage_kind
from store.telemetry import span

logger = logging.getLogger(__name__)


class StageLog:
    """Of one attempt, in its thread; use it as a context."""

    def __init__(self) -> None:
        self._stage: str | None = None
        self._began = 0.0
        self._span = ExitStack()

    def __enter__(self) -> StageLog:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def follow(self, stage: str) -> None:
        """The attempt is in this stage now; names of surfaces in it are left out."""
        stage = stage_kind(stage)
        if stage == self._stage:
            return
        self._end()
        self._stage, self._began = stage, time.monotonic()
        add_log_context(stage=stage)
        self._span.enter_context(span(f"stage {stage}")).note(integument__stage=stage)

    def _end(self) -> None:
        if self._stage is None:
            return
        self._span.close()
        seconds = round(time.monotonic() - self._began, 3)
        logger.info("stage %s took %.3f s", self._stage, seconds, extra={"event": "stage_ended", "fields": {"seconds": seconds}})
        self._stage = None
