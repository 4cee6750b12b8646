"""What a freshly forked child gives up before it looks at anybody's data (docs/adr/0009-confined-children.md)."""

from __future__ import annotations

import faulthandler
import logging
import os
import resource
import signal
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from sandbox.call_filter import refuse_calls
from sandbox.capabilities import drop_capabilities
from sandbox.kernel import (
    CLONE_NEWNET,
    CLONE_NEWUSER,
    PR_SET_CHILD_SUBREAPER,
    PR_SET_NO_NEW_PRIVS,
    PR_SET_PDEATHSIG,
    ask_for_turns,
    set_process_flag,
    unshare,
)
from sandbox.kernel_cache import keep_kernels_in_memory
from sandbox.landlock import confine_files
from sandbox.limits import MIB, Limits
from sandbox.survey import NO_FILTER, NO_LANDLOCK
from sandbox.visible_files import WRITABLE, visible_files

logger = logging.getLogger(__name__)

EVENTS_FD = 3  # the only descriptor kept besides the standard three
LOG_NAME = "child.log"
CPU_GRACE_S = 5  # between SIGXCPU and SIGKILL
MEMORY_RESERVE_BYTES = 64 * MIB  # address space kept back so that "out of memory" can still be said
OOM_SCORE = "500"  # the kernel shall take the child first, never the worker
NICENESS = 5  # a third of the share of others, not less: children of an overloaded host must get on, too
SLICE_NS = 100_000_000  # the longest the kernel takes


def tie_to(nursery_pid: int) -> None:
    """Own session, death with the nursery, no way up. First act of the child; ends it if the nursery is gone already."""
    os.setsid()
    set_process_flag(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != nursery_pid:  # died between fork and prctl
        os._exit(1)
    set_process_flag(PR_SET_NO_NEW_PRIVS, 1)
    set_process_flag(PR_SET_CHILD_SUBREAPER, 1)  # whatever it starts stays below it until it ends
    Path("/proc/self/oom_score_adj").write_text(OOM_SCORE)
    give_way()


def give_way() -> None:
    """Whoever computes for minutes steps back behind those who answer: API, worker and databases.

    Long turns: whoever asks for shorter ones, as all others do, and wakes up takes the processor at once, not at the end of ours.
    The share stays what it is."""
    os.nice(NICENESS)
    ask_for_turns(SLICE_NS)
    with suppress(OSError):  # by sessions the kernel shares the processor out first, where it is built so; ours is one of its own
        Path("/proc/self/autogroup").write_text(str(NICENESS))


def prepare_ahead() -> None:
    """What every child gives up whatever its job is, so that it need not wait for it then. After `tie_to`."""
    leave_network()
    keep_kernels_in_memory()


def keep_only(events: int, scratch: Path) -> None:
    """Standard input empty, output into scratch/child.log, the event pipe as EVENTS_FD, everything else closed."""
    nothing = os.open(os.devnull, os.O_RDONLY)
    log = os.open(scratch / LOG_NAME, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    os.dup2(nothing, 0)
    os.dup2(log, 1)
    os.dup2(log, 2)
    if events != EVENTS_FD:
        os.dup2(events, EVENTS_FD, inheritable=False)
    os.closerange(EVENTS_FD + 1, os.sysconf("SC_OPEN_MAX"))
    faulthandler.enable(file=2, all_threads=True)


def restrict(limits: Limits, scratch: Path, readable: Iterable[Path], target: str) -> list[str]:
    """Working folder, environment, resource limits, powers, files, system calls, in this order.

    `readable`: inputs outside `scratch`. Returns what this kernel cannot do, in words; raises OSError or ValueError when it
    refuses."""
    os.chdir(scratch)
    os.umask(0o077)
    os.environ["TMPDIR"] = str(scratch)
    tempfile.tempdir = None  # forget what the parent found while it warmed up
    _limit(resource.RLIMIT_CORE, 0, 0)
    _limit(resource.RLIMIT_NOFILE, limits.open_files, limits.open_files)
    _limit(resource.RLIMIT_FSIZE, limits.file_bytes, limits.file_bytes)
    _limit(resource.RLIMIT_CPU, limits.cpu_s, limits.cpu_s + CPU_GRACE_S)
    warm = address_space_bytes()
    _limit(resource.RLIMIT_AS, warm + limits.memory_bytes, warm + limits.memory_bytes + MEMORY_RESERVE_BYTES)
    drop_capabilities()
    missing = []
    if confine_files([*visible_files(target), *readable], [scratch, *map(Path, WRITABLE)]) == 0:
        missing.append(NO_LANDLOCK)
    if not refuse_calls(forks=limits.forks):
        missing.append(NO_FILTER)
    for lack in missing:
        logger.warning("not confined: %s", lack)
    return missing


def release_reserve() -> None:
    """After a MemoryError: enough room to report it."""
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (hard, hard))


def address_space_bytes() -> int:
    """Size of this process' address space now: what the warm nursery has mapped is not the job's doing."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")


def leave_network() -> None:
    """Move to an empty network namespace: as root directly, else through a user namespace; logged where neither is allowed."""
    try:
        unshare(CLONE_NEWNET)
    except OSError:
        try:
            unshare(CLONE_NEWUSER | CLONE_NEWNET)
        except OSError as error:
            logger.warning("the child keeps the host's network: %s", error)


def _limit(kind: int, soft: int, hard: int) -> None:
    """Lower a limit; what the host already holds lower stays."""
    _, present = resource.getrlimit(kind)
    if present != resource.RLIM_INFINITY:
        hard = min(hard, present)
    resource.setrlimit(kind, (min(soft, hard), hard))
