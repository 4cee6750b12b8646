"""Does what the plan says, undoes it, and starts again what has ended, as a container engine would."""

from __future__ import annotations

import signal
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

import psutil
from sqlalchemy import select
from sqlalchemy.exc import DBAPIError

from store.database import Database
from store.job import JobStatus
from store.records import JobRow
from tests.acceptance.faults.fault import Fault, Kind
from tests.acceptance.faults.premises import PLACES, Premises
from tests.acceptance.faults.small_disks import empty, fill
from tests.acceptance.member import Member
from tests.children import children_at_work

HUNT_S = 8.0  # a child has to be there before it can be killed


class Injector:
    """For one thread, which has to live as long as what it starts."""

    def __init__(self, premises: Premises, tell: Callable[[str], None]) -> None:
        self._premises = premises
        self._tell = tell
        self._down: set[str] = set()  # hosts that stay down until their fault ends
        self._undo: dict[Fault, Callable[[], None]] = {}
        self._hunted: list[Fault] = []
        self.done: Counter[str] = Counter()
        self.missed: list[Fault] = []
        self.deaths: Counter[str] = Counter()  # exit codes nobody asked for
        self.robbed: list[tuple[str, datetime]] = []  # job and the moment its worker was killed
        self._asked: set[int] = set()  # processes we ended ourselves

    def begin(self, fault: Fault) -> None:
        """What cannot be hit yet is tried again by `watch`."""
        if not self._strike(fault):
            self._hunted.append(fault)

    def end(self, fault: Fault) -> None:
        """Undo it."""
        undo = self._undo.pop(fault, None)
        if undo is not None:
            undo()

    def watch(self, now_s: float) -> None:
        """Start again whoever has ended; try again what found nothing to hit."""
        for host in PLACES:
            member = self._premises.member(host)
            if not member.is_running and host not in self._down:
                code = member.process.poll()
                if member.process.pid not in self._asked:
                    self.deaths[f"{host} ended by itself with {code}"] += 1
                    self._tell(f"{host} ended by itself with {code}")
                member.start()
        for fault in tuple(self._hunted):
            if self._strike(fault):
                self._hunted.remove(fault)
            elif now_s > fault.at_s + HUNT_S:
                self._hunted.remove(fault)
                self.missed.append(fault)

    def heal(self) -> None:
        """Undo all that is still open; everybody is started again."""
        self.missed += self._hunted
        self._hunted.clear()
        for fault in tuple(self._undo):
            self.end(fault)
        self._down.clear()
        self.watch(0.0)

    def _strike(self, fault: Fault) -> bool:
        what, _, host = fault.target.rpartition(" of ")
        act = {
            "": self._strike_part,
            "child": self._strike_below,
            "nursery": self._strike_below,
            "connection": self._strike_connection,
            "database": self._shut_gate,
            "disk": self._fill_disk,
            "clock": self._set_clock,
        }[what]
        if not act(fault, host):
            return False
        self.done[f"{fault.kind} {what or host.partition('-')[0]}"] += 1
        return True

    def _strike_part(self, fault: Fault, part: str) -> bool:
        if part in PLACES:
            return self._strike_member(fault, self._premises.member(part))
        if part == "store":
            return self._shut_gate(fault, part)
        return self._strike_server(fault, part)

    def _strike_member(self, fault: Fault, member: Member) -> bool:
        if not member.is_running:
            return False
        process, host = member.process, member.host
        if fault.kind is Kind.PAUSE:
            member.signal(signal.SIGSTOP)
            self._undo[fault] = lambda: process.send_signal(signal.SIGCONT)
            return True
        self._asked.add(process.pid)
        if fault.kind is Kind.RESTART:
            member.signal(signal.SIGTERM)
            return True
        robbed = self._jobs_of(process.pid)
        self._down.add(host)
        member.kill()
        self.robbed += [(job, datetime.now(UTC)) for job in robbed]
        self._undo[fault] = lambda: self._down.discard(host)
        return True

    def _jobs_of(self, pid: int) -> list[str]:
        """What a worker holds; nothing if the database is away, too."""
        database = Database(self._premises.direct)
        query = select(JobRow.id).where(JobRow.status == JobStatus.RUNNING, JobRow.lease_owner.endswith(f":{pid}"))
        try:
            if self._premises.postgres.process is None or self._is_paused("postgres"):
                return []
            with database.engine.connect() as connection:
                return [str(job) for job in connection.scalars(query)]
        except DBAPIError:
            return []
        finally:
            database.close()

    def _is_paused(self, part: str) -> bool:
        return any(open_fault.target == part and open_fault.kind is Kind.PAUSE for open_fault in self._undo)

    def _strike_below(self, fault: Fault, host: str) -> bool:
        member = self._premises.member(host)
        found: list[psutil.Process] = []
        with suppress(psutil.NoSuchProcess):
            if member.is_running:
                worker = psutil.Process(member.process.pid)
                found = worker.children() if fault.target.startswith("nursery") else list(children_at_work(worker).values())
        if not found:
            return False
        victim = sorted(found, key=lambda process: process.pid)[fault.draw % len(found)]
        with suppress(psutil.NoSuchProcess):
            if fault.kind is Kind.KILL:
                victim.kill()
                return True
            victim.suspend()
            self._undo[fault] = lambda: _resume(victim)
            return True
        return False

    def _strike_connection(self, fault: Fault, _server: str) -> bool:
        backends = [process for process in self._premises.postgres.family()[1:] if _serves_us(process)]
        if not backends or self._is_paused("postgres"):
            return False
        with suppress(psutil.NoSuchProcess):
            backends[fault.draw % len(backends)].kill()
            return True
        return False

    def _strike_server(self, fault: Fault, name: str) -> bool:
        server = self._premises.valkey if name == "valkey" else self._premises.postgres
        if server.process is None or self._is_paused(name):
            return False
        if fault.kind is Kind.PAUSE:
            server.signal(signal.SIGSTOP)
            self._undo[fault] = lambda: server.signal(signal.SIGCONT)
        elif fault.kind is Kind.RESTART:
            self._premises.postgres.restart()
        else:
            server.kill()
            if fault.kind is Kind.EMPTY:
                self._premises.valkey.empty()
            self._undo[fault] = server.start
        return True

    def _shut_gate(self, fault: Fault, host: str) -> bool:
        gate = self._premises.store if host == "store" else self._premises.databases[host]
        if any(open_fault.target == fault.target for open_fault in self._undo):
            return False
        gate.shut(fault.kind)
        self._undo[fault] = gate.open
        return True

    def _fill_disk(self, fault: Fault, host: str) -> bool:
        fill(self._premises.disk(host))
        self._undo[fault] = lambda: empty(self._premises.disk(host))
        return True

    def _set_clock(self, fault: Fault, host: str) -> bool:
        self._move_clock(host, fault.hours * 3600)
        self._undo[fault] = lambda: self._move_clock(host, 0.0)
        return True

    def _move_clock(self, host: str, off_s: float) -> None:
        self._premises.clock(host).write_text(str(off_s))
        member = self._premises.member(host)
        if member.is_running and _catches(member.process.pid, signal.SIGRTMIN):  # else it has yet to look for itself
            member.signal(signal.SIGRTMIN)


def _resume(process: psutil.Process) -> None:
    with suppress(psutil.NoSuchProcess):
        process.resume()


def _catches(pid: int, number: signal.Signals) -> bool:
    """Whether the process has a handler for a signal that would end it otherwise."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False
    caught = next(line for line in status.splitlines() if line.startswith("SigCgt:"))
    return bool(int(caught.partition(":")[2], 16) >> (number - 1) & 1)


def _serves_us(process: psutil.Process) -> bool:
    """False for the server's chores, which have other names, and for what has just ended."""
    try:
        return "integument" in " ".join(process.cmdline())
    except psutil.NoSuchProcess:
        return False
