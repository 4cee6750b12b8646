"""The key of a step's output: everything that decides about its bytes."""

from __future__ import annotations

import hashlib
import json

import numpy as np

from core.processes.checkpoints.plain import to_plain


def key_of(generation: str, stage: str, depends: tuple[object, ...]) -> str:
    """SHA-256 in hexadecimal over the software's `generation`, the name of the stage and all it depends on, arrays bit for bit.

    Raises TypeError for what `to_plain` cannot take apart.
    """
    plain = to_plain(depends)
    digest = hashlib.sha256(json.dumps([generation, stage, plain.tree]).encode())
    for array in plain.arrays:
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
