"""`python -m api`: serve HTTP until SIGINT or SIGTERM."""

from __future__ import annotations

import signal
import socket
import sys
from collections.abc import Callable
from types import FrameType

import uvicorn
from pydantic import ValidationError

from api.app import create_app
from api.binding import require_allowed_binding
from api.guarded_connection import guarded_connections
from core.errors import IntegumentError
from sandbox.frozen_heap import freeze_heap
from sandbox.log_lines import configure_logging
from sandbox.survey import survey_confinement
from store.redaction import Redaction
from store.settings import Settings
from store.telemetry import start_telemetry, stop_telemetry

GRACE_S = 5  # for answers under way; streams and long polls end at once


class DrainingServer(uvicorn.Server):
    """Tells the application of the signal at once: uvicorn waits for open streams before it ends the lifespan."""

    def __init__(self, config: uvicorn.Config, begin_drain: Callable[[], None]) -> None:
        super().__init__(config)
        self._begin_drain = begin_drain

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        freeze_heap()

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        self._begin_drain()
        super().handle_exit(sig, frame)


def main() -> int:
    """0 after a clean stop, 2 if the settings are at fault; SystemExit 3 (uvicorn's) if it cannot start."""
    try:
        settings = Settings()
        configure_logging(settings.log_format, Redaction.of(settings))
        require_allowed_binding(settings)
        survey_confinement(required=settings.require_confinement)
        start_telemetry("api")
    except (ValidationError, IntegumentError) as error:
        print(f"python -m api: {error}", file=sys.stderr)
        return 2
    app = create_app(settings)
    config = uvicorn.Config(
        app,
        http=guarded_connections(settings),
        host=settings.host,
        port=settings.port,
        log_config=None,  # its lines are like ours; requests are told of by api.request_log
        log_level="warning",
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=GRACE_S,
        timeout_keep_alive=30,
        proxy_headers=False,
        lifespan="on",
    )
    for number in (signal.SIGINT, signal.SIGTERM):  # uvicorn raises the signal again once it has stopped: that is no failure
        signal.signal(number, lambda _number, _frame: sys.exit(0))
    try:
        DrainingServer(config, app.state.services.drain.begin).run()
    finally:
        stop_telemetry()
    return 0


if __name__ == "__main__":
    sys.exit(main())
