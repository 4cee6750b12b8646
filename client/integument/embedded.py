"""The server for one call: a running one is shared, else one is started and goes when its last user is gone.

Every user holds `clients.lock` shared. A server started here runs with `--while-used`: it waits for the same lock
exclusively and stops when it gets it. So it also goes when the user was killed, and stays while another call needs it.
"""

from __future__ import annotations

import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from integument.data_folder import DataFolder, default_data_dir
from integument.errors import ServerNotInstalledError, ServerStartError
from integument.file_lock import FileLock
from integument.server_entry import server_is_installed

START_TIMEOUT_S = 90.0
STOP_TIMEOUT_S = 40.0
LOOK_S = 0.1  # between two looks at a server that is starting
LOG_TAIL_LINES = 15


class EmbeddedServer:
    """`with EmbeddedServer() as server, Client(server.url) as client: ...`

    data_dir: what the server keeps; uploads and results are still there for the next call.
    """

    def __init__(self, data_dir: Path | None = None) -> None:
        self.folder = DataFolder((data_dir or default_data_dir()).absolute())
        self.url = ""
        self._process: subprocess.Popen[bytes] | None = None
        self._count: FileLock | None = None
        self._held = ExitStack()

    @property
    def started_here(self) -> bool:
        """False if a running server is shared."""
        return self._process is not None

    def __enter__(self) -> Self:
        """Raises: ServerNotInstalledError, ServerStartError."""
        try:
            self.folder.path.mkdir(parents=True, exist_ok=True, mode=0o700)
            with self._held:
                self._held.enter_context(FileLock(self.folder.clients_lock, shared=True))
                self._count = self._held.enter_context(FileLock(self.folder.count_lock, shared=True))
                with FileLock(self.folder.start_lock):
                    self.url = self.folder.running_url() or self._start()
                self._held = self._held.pop_all()
        except OSError as error:
            raise ServerStartError(f"cannot use the data folder {self.folder.path}: {error.strerror or error}") from error
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Leave; wait for the end of the server if it was started here and nobody else uses it."""
        last = self._count is not None and self._count.held_alone()
        self._held.close()  # this is what tells the server
        if self._process is not None and last:
            _await_end(self._process)

    def _start(self) -> str:
        if not server_is_installed():
            raise ServerNotInstalledError
        command = [sys.executable, "-m", "integument", "serve", "--port", "0", "--while-used"]
        with self.folder.log.open("wb") as log:
            # own session: Ctrl-C in the terminal is for the caller, who ends the job first
            self._process = subprocess.Popen(  # noqa: S603 our own command line
                [*command, "--data-dir", str(self.folder.path)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        try:
            return self._wait_until_ready(self._process)
        except BaseException:
            self._process.terminate()
            _await_end(self._process)
            raise

    def _wait_until_ready(self, process: subprocess.Popen[bytes]) -> str:
        deadline = time.monotonic() + START_TIMEOUT_S
        while time.monotonic() < deadline:
            url = self.folder.running_url()
            if url is not None:
                return url
            try:
                process.wait(LOOK_S)
            except subprocess.TimeoutExpired:
                continue
            raise ServerStartError(f"the server ended with exit code {process.returncode}:\n{self._log_tail()}")
        raise ServerStartError(f"the server was not ready within {START_TIMEOUT_S:g} s:\n{self._log_tail()}")

    def _log_tail(self) -> str:
        lines = self.folder.log.read_text(encoding="utf-8", errors="replace").splitlines()
        return "\n".join(lines[-LOG_TAIL_LINES:]) or "(it printed nothing)"


def _await_end(process: subprocess.Popen[bytes]) -> None:
    try:
        process.wait(STOP_TIMEOUT_S)
    except subprocess.TimeoutExpired:
        process.kill()  # its parts go with it
        process.wait()
