"""The embedded set-up: Valkey, worker and API in one data folder."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Mapping

from core.errors import IntegumentError, InternalError
from server.address import base_url
from server.data_folder import DataFolder
from server.log_file import LogFile
from server.part import Part, Program
from server.readiness import ask_api
from server.stop_signals import StopSignals
from server.supervisor import Supervisor
from server.valkey import answers, set_aside_append_only, valkey_program
from store.database import Database
from store.jobs import Jobs
from store.settings import Settings

API_COMMAND = ("-m", "api")
WORKER_COMMAND = ("-m", "worker")
API_GRACE_S = 10.0
WORKER_GRACE_S = 10.0  # beyond the time its jobs have to end
VALKEY_START_S = 20.0
API_START_S = 80.0
LOOK_S = 0.05  # between two looks at a part that is starting

Announce = Callable[[str], None]


class Embedded:
    """The three parts in their order, stopped the other way round."""

    def __init__(self, folder: DataFolder, settings: Settings, signals: StopSignals, announce: Announce) -> None:
        """`settings` are those of API and worker; broker_url must lead to `folder.socket_path`."""
        self._folder = folder
        self._announce = announce
        self._settings = settings
        self._database = Database(settings)
        environment = {**os.environ, **settings.as_environment(), "PYTHONSAFEPATH": "1", "PYTHONUNBUFFERED": "1"}
        self._valkey = self._part(valkey_program(folder.valkey, folder.socket_path))
        worker_grace_s = settings.drain_s + WORKER_GRACE_S
        self._worker = self._part(_python_program("worker", WORKER_COMMAND, environment, worker_grace_s, folder))
        self._api = self._part(_python_program("api", API_COMMAND, environment, API_GRACE_S, folder))
        self._valkey_answered = False
        self._supervisor = Supervisor(signals, announce, self._after_crash)

    def run(self) -> None:
        """Until asked to stop. Raises: InternalError `server.part_*` when a part cannot be kept alive."""
        try:
            self._start()
            self._supervisor.run()
        finally:
            self._folder.withdraw()
            self._supervisor.stop()
            self._database.close()

    def _part(self, program: Program) -> Part:
        return Part(program, LogFile(self._folder.logs / f"{program.name}.log"), self._folder.lock_fd)

    def _start(self) -> None:
        self._supervisor.start(self._valkey)
        if not self._comes_up(self._valkey, self._ask_valkey, VALKEY_START_S):
            return
        self._valkey_answered = True
        self._database.migrate()
        Jobs(self._database).expire_all_leases()  # we hold the folder: whoever worked here is dead
        self._supervisor.start(self._worker)
        self._supervisor.start(self._api)
        if self._comes_up(self._api, lambda: ask_api(self._settings.host, self._settings.port), API_START_S):
            url = base_url(self._settings.host, self._settings.port)
            self._folder.publish(url)
            self._announce(f"Integument answers at {url} (data in {self._folder.path}; Ctrl-C stops it).")

    def _ask_valkey(self) -> str | None:
        return None if answers(self._folder.socket_path) else "no answer to PING"

    def _comes_up(self, part: Part, ask: Callable[[], str | None], limit_s: float) -> bool:
        """False: we are asked to stop before. `ask` says what is missing. Raises: InternalError `server.part_not_ready`."""
        deadline = time.monotonic() + limit_s
        while not self._supervisor.run(LOOK_S):
            missing = ask()
            if missing is None:
                return True
            if time.monotonic() > deadline:
                raise InternalError(
                    "server.part_not_ready",
                    f"The {part.name} was not ready within {limit_s:.0f} s: {missing}. "
                    f"The end of {part.log.path}:\n{part.log.tail()}",
                    part=part.name,
                    limit_s=limit_s,
                )
        return False

    def _after_crash(self, part: Part) -> None:
        if part is self._worker:
            self._take_jobs_back()
        elif part is self._valkey and not self._valkey_answered and (aside := set_aside_append_only(self._folder.valkey)):
            self._announce(f"Valkey cannot read its append-only file; it is set aside as {aside} and the queue rebuilt.")

    def _take_jobs_back(self) -> None:
        """There is no other worker here, so nobody needs to wait for the leases of the dead one."""
        try:
            Jobs(self._database).expire_all_leases(worker_crashed=True)
        except IntegumentError as error:
            self._announce(f"The jobs of the lost worker go on when their leases end: {error.message}")


def _python_program(
    name: str, command: tuple[str, ...], environment: Mapping[str, str], grace_s: float, folder: DataFolder
) -> Program:
    return Program(name, (sys.executable, *command), environment, grace_s, str(folder.path))
