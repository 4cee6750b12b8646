"""TetGen in a forked process: on sets it does not like it ends its process, which must not be that of the job."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import tetgen
from numpy.typing import NDArray

from core.errors import InputError

SAID_CHARACTERS = 2000
REFUSED = 1


@dataclass(frozen=True, eq=False, slots=True)
class Facets:
    """What TetGen is given.

    vertices: (V, 3) mm; faces: (F, 3). points: (N, 3), one in each space to fill; region: (N,) its number, above 0;
    largest: (N,) largest tetrahedron in mm³, 0 for any.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    points: NDArray[np.float64]
    region: NDArray[np.int64]
    largest: NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Filling:
    """What TetGen made: nodes (V, 3), tetrahedra (T, 4), region (T,), other numbers than those given for other spaces."""

    nodes: NDArray[np.float64]
    tetrahedra: NDArray[np.int32]
    region: NDArray[np.int32]


def run_tetgen(facets: Facets, switches: str) -> Filling:
    """Raises: InputError `tetrahedra.refused` with what TetGen said, also if its process crashed."""
    with TemporaryDirectory(prefix="tetgen-") as folder:
        made, said = Path(folder) / "made.npz", Path(folder) / "said"
        pid = os.fork()
        if pid == 0:
            _work_and_exit(facets, switches, made, said)
        _, status = os.waitpid(pid, 0)
        code = os.waitstatus_to_exitcode(status)
        if code:
            ended = f"crashed with signal {-code}" if code < 0 else "refuses the surfaces"
            words = said.read_text(encoding="utf-8") if said.exists() else "nothing"
            raise InputError("tetrahedra.refused", f"TetGen {ended}; it said: {words}", exit_code=code)
        with np.load(made, allow_pickle=False) as result:
            return Filling(result["nodes"], result["tetrahedra"], np.rint(result["region"]).astype(np.int32).ravel())


def _work_and_exit(facets: Facets, switches: str, made: Path, said: Path) -> None:
    """The whole life of the forked process; nothing of its parent's is run again at its end."""
    os.chdir(made.parent)  # it leaves files where it stands
    try:
        filler = tetgen.TetGen(facets.vertices, facets.faces)
        for number, point, largest in zip(facets.region, facets.points, facets.largest, strict=True):
            filler.add_region(int(number), tuple(point.tolist()), float(largest))
        nodes, tetrahedra, region, *_ = filler.tetrahedralize(switches=switches)
        with made.open("wb") as file:
            np.savez(file, nodes=nodes, tetrahedra=tetrahedra, region=region)
        os._exit(0)
    except BaseException as error:  # noqa: BLE001 - nothing may leave the forked process but its exit
        said.write_text(f"{error}"[:SAID_CHARACTERS], encoding="utf-8")
    finally:
        os._exit(REFUSED)
