"""What a job is expected to need, told from its inputs before it runs: memory, processor time and so its queue."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

MB = 1_000_000
FAST_S = 20.0  # expected processor time up to which a job is fast
MARGIN = 1.25  # anatomy differs: above the straight lines through what the body needed


class JobQueue(StrEnum):
    """Jobs of seconds wait apart from jobs of minutes."""

    FAST = "fast"
    HEAVY = "heavy"


@dataclass(frozen=True, slots=True)
class Expectation:
    """`memory_bytes` at the peak, of the child and all it starts; `cpu_s` of one attempt, None if nobody can tell."""

    memory_bytes: int
    cpu_s: float | None

    @property
    def queue(self) -> JobQueue:
        """What may take long, and what nobody knows, is heavy."""
        return JobQueue.FAST if self.cpu_s is not None and self.cpu_s <= FAST_S else JobQueue.HEAVY


UNKNOWN = Expectation(memory_bytes=1024**3, cpu_s=None)
"""Of jobs whose acceptance said nothing: the defaults of the table's columns."""


@dataclass(frozen=True, slots=True)
class _Need:
    """A straight line each for memory and time: what a surface costs however small, and what each of its faces adds."""

    mb: float
    bytes_per_face: float
    s: float
    s_per_face: float
    mb_per_layer: float = 0.0
    s_per_layer: float = 0.0


# the child with the libraries loaded, pages shared with its parent counted, has 190 MB; drawing the figures takes it to 350 MB
_NEEDS: Mapping[str, _Need] = {
    "validate": _Need(mb=370, bytes_per_face=150, s=1.0, s_per_face=10e-6),
    "shells": _Need(mb=300, bytes_per_face=220, s=0.0, s_per_face=80e-6, mb_per_layer=55, s_per_layer=2.0),
    "ears": _Need(mb=310, bytes_per_face=220, s=2.0, s_per_face=80e-6, mb_per_layer=55, s_per_layer=2.0),
    "graft": _Need(mb=380, bytes_per_face=500, s=2.0, s_per_face=45e-6),
    "heal": _Need(mb=250, bytes_per_face=500, s=0.5, s_per_face=20e-6),
    "decimate": _Need(mb=300, bytes_per_face=550, s=1.0, s_per_face=25e-6),
    "tetrahedralize": _Need(mb=400, bytes_per_face=4000, s=2.0, s_per_face=130e-6),
    "smooth": _Need(mb=390, bytes_per_face=250, s=1.5, s_per_face=45e-6),
}
DEFAULT_ITERATIONS = 20


def expect(process: str, inputs: Mapping[str, Any], faces: int) -> Expectation:
    """What one attempt needs; `inputs` as they are stored, `faces` of all meshes the job reads together.

    Each of n layers works on the faces of the skin, and all surfaces are there at the end. Smoothing that is told to make all its
    iterations takes time for each. Source: `python -m benchmarks.expectations`, docs/benchmarks.md."""
    need = _NEEDS.get(process)
    if need is None:
        return UNKNOWN
    layers = len(inputs.get("layers") or ())
    surfaces, passes = layers + 1, float(max(layers, 1))
    if inputs.get("stop") == "iterations":
        passes *= max(float(inputs.get("iterations", DEFAULT_ITERATIONS)) / DEFAULT_ITERATIONS, 1.0)
    memory_bytes = MB * (need.mb + need.mb_per_layer * layers) + need.bytes_per_face * faces * surfaces
    cpu_s = need.s + need.s_per_layer * layers + need.s_per_face * faces * passes
    return Expectation(memory_bytes=int(MARGIN * memory_bytes), cpu_s=round(cpu_s, 1))
