"""A mesher in a forked process: on sets it does not like it ends its process, which must not be that of the job."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, LimitError, StateError

SAID_CHARACTERS = 2000
REFUSED, MISSING, NO_MEMORY = 1, 2, 3


class MesherMissing(Exception):
    """The mesher, or a library of the system that it needs, is not installed; the message says how to."""


@dataclass(frozen=True, eq=False, slots=True)
class Filling:
    """What a mesher made: nodes (V, 3), those of the surfaces first; tetrahedra (T, 4); region (T,), other numbers than those
    given for spaces that were not asked for."""

    nodes: NDArray[np.float64]
    tetrahedra: NDArray[np.int32]
    region: NDArray[np.int32]


def run_forked(mesher: str, work: Callable[[], Filling]) -> Filling:
    """What `work` makes in a process of its own; mesher: its name for messages.

    Raises: InputError `tetrahedra.refused` with what it said, also if its process crashed; LimitError `limit.memory`;
    StateError `tetrahedra.no_mesher`.
    """
    with TemporaryDirectory(prefix="mesher-") as folder:
        made, said = Path(folder) / "made.npz", Path(folder) / "said"
        pid = os.fork()
        if pid == 0:
            _work_and_exit(work, made, said)
        _, status = os.waitpid(pid, 0)
        code = os.waitstatus_to_exitcode(status)
        words = said.read_text(encoding="utf-8") if said.exists() else "nothing"
        if code == MISSING:
            raise StateError("tetrahedra.no_mesher", f"{mesher} cannot be used on this server: {words}")
        if code == NO_MEMORY:
            raise LimitError("limit.memory", f"{mesher} needs more memory than this server allows for one job")
        if code:
            ended = f"crashed with signal {-code}" if code < 0 else "refuses the surfaces"
            raise InputError("tetrahedra.refused", f"{mesher} {ended}; it said: {words}", exit_code=code)
        with np.load(made, allow_pickle=False) as result:
            return Filling(result["nodes"], result["tetrahedra"], result["region"])


def _work_and_exit(work: Callable[[], Filling], made: Path, said: Path) -> None:
    """The whole life of the forked process; nothing of its parent's is run again at its end."""
    code = REFUSED
    try:
        os.chdir(made.parent)  # meshers leave files where they stand
        filling = work()
        with made.open("wb") as file:
            np.savez(file, nodes=filling.nodes, tetrahedra=filling.tetrahedra, region=filling.region)
        code = 0
    except BaseException as error:  # noqa: BLE001 - nothing may leave the forked process but its exit
        code = MISSING if isinstance(error, MesherMissing) else NO_MEMORY if _lacks_memory(error) else REFUSED
        said.write_text(f"{error}"[:SAID_CHARACTERS], encoding="utf-8")
    finally:
        os._exit(code)


def _lacks_memory(error: BaseException) -> bool:
    return isinstance(error, MemoryError) or "out of memory" in str(error).lower()
