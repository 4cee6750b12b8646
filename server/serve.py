"""`integument serve`: the embedded set-up as one call."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from pydantic import ValidationError

from api.binding import require_allowed_binding
from core.errors import InputError, IntegumentError, StateError
from server.address import choose_port
from server.data_folder import DataFolder
from server.embedded import Announce, Embedded
from server.stop_signals import StopSignals
from server.valkey import broker_url
from store.settings import Settings

DATABASE = "integument.sqlite3"
DRAIN_S = 3.0  # whoever presses Ctrl-C waits for it; jobs that did not end by then start over next time


def serve(*, data_dir: Path, host: str = "127.0.0.1", port: int = 8000, announce: Callable[[str], None] | None = None) -> int:
    """Run API, worker and a private Valkey until SIGINT, SIGTERM or SIGHUP; main thread only. `port` 0 takes a free one.

    What the user should know, failures too, goes to `announce` (default: stderr). Once the server answers, its address is
    in `data_dir`/server.json too.
    Returns the exit code: 0 stopped as asked, 1 a part failed, 2 the request was at fault (settings, host, port, folder).
    """
    tell = announce or _to_stderr
    try:
        _serve(data_dir, host, port, tell)
    except ValidationError as error:  # from the environment; its text names the setting and hides the value
        tell(str(error))
        return 2
    except IntegumentError as error:
        tell(f"{error.message} [{error.code}]")
        return 2 if isinstance(error, InputError | StateError) else 1
    return 0


def _serve(data_dir: Path, host: str, port: int, tell: Announce) -> None:
    # never a foreign database: the lock guards this folder only
    given = Settings(data_dir=data_dir, database_url=f"sqlite:///{data_dir.absolute()}/{DATABASE}", host=host, port=port)
    require_allowed_binding(given)
    folder = DataFolder(data_dir)
    try:
        port = choose_port(host, port)
        settings = Settings(
            data_dir=folder.path,
            database_url=f"sqlite:///{folder.path}/{DATABASE}",
            broker_url=broker_url(folder.socket_path),
            host=host,
            port=port,
            drain_s=given.drain_s if "drain_s" in given.model_fields_set else DRAIN_S,
        )
        with StopSignals() as signals:
            Embedded(folder, settings, signals, tell).run()
    finally:
        folder.release()


def _to_stderr(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
