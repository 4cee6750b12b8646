"""`python -m benchmarks.heal_entries HEALER FOLDER`: mend one entry after the other, as standard input names them by number.

Leaves `NUMBER.npz` in the folder and answers each with one line of JSON: {"seconds"} or {"refused"} or {"failed"}.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np

from benchmarks.healers import HEALERS
from core.errors import InputError
from subjects.defects import CORPUS


def main() -> None:
    """Arguments as in the module's first line; the end of standard input ends it."""
    healer, folder = HEALERS[sys.argv[1]], Path(sys.argv[2])
    quick = next(entry for entry in CORPUS if entry.quick)
    healer(quick.make(), quick)  # compile before the clock starts
    answers = sys.stdout
    sys.stdout = sys.stderr  # libraries talk
    print(json.dumps({"ready": True}), file=answers, flush=True)
    for line in sys.stdin:
        entry = CORPUS[int(line)]
        damaged = entry.make()
        start = time.process_time()
        try:
            result = healer(damaged, entry)
        except InputError as refusal:
            told = {"refused": refusal.code, "seconds": time.process_time() - start}
        except Exception as failure:  # noqa: BLE001 - whatever a peer raises is its answer
            told = {"failed": repr(failure)[:200], "seconds": time.process_time() - start}
        else:
            told = {"seconds": time.process_time() - start}
            np.savez(folder / f"{int(line)}.npz", vertices=result.vertices, faces=result.faces)
        print(json.dumps(told), file=answers, flush=True)


if __name__ == "__main__":
    main()
