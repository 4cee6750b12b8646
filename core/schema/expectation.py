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


LOADED_MB = 190  # the child with the libraries and nothing else; pages it shares with its parent are counted


@dataclass(frozen=True, slots=True)
class _Need:
    """figures_mb, figures_mb_per_layer: what drawing the report takes, the peak of small jobs. bytes_per_face: of every surface
    there is at the end; bytes_per_face2: times the square of the faces that came. Both: what the geometry of large ones takes."""

    figures_mb: float
    bytes_per_face: float
    s: float
    s_per_face: float
    figures_mb_per_layer: float = 0.0
    s_per_layer: float = 0.0
    bytes_per_face2: float = 0.0


_NEEDS: Mapping[str, _Need] = {
    "validate": _Need(370, 450, s=1.0, s_per_face=10e-6),
    "shells": _Need(300, 850, s=0.0, s_per_face=85e-6, figures_mb_per_layer=65, s_per_layer=2.0),
    "ears": _Need(310, 650, s=2.0, s_per_face=100e-6, figures_mb_per_layer=65, s_per_layer=2.0, bytes_per_face2=0.0185),
    "graft": _Need(400, 900, s=2.0, s_per_face=45e-6),
    "heal": _Need(200, 540, s=0.5, s_per_face=21e-6),
    "decimate": _Need(300, 590, s=1.0, s_per_face=26e-6),
    "tetrahedralize": _Need(400, 5600, s=2.0, s_per_face=160e-6),
    "tetrahedralize by gmsh": _Need(400, 5600, s=2.0, s_per_face=250e-6),
    "detach": _Need(400, 900, s=12.0, s_per_face=30e-6),
    "separate": _Need(400, 850, s=3.0, s_per_face=130e-6),
    "segment": _Need(400, 450, s=3.0, s_per_face=170e-6),
    "fields": _Need(270, 900, s=1.5, s_per_face=7e-6),
    "smooth": _Need(400, 850, s=1.5, s_per_face=45e-6),
}
DEFAULT_ITERATIONS = 20
SLOWER_MESHERS = ("gmsh",)


def expect(process: str, inputs: Mapping[str, Any], faces: int) -> Expectation:
    """What one attempt needs; `inputs` as they are stored, `faces` of all meshes the job reads together.

    Each of n layers works on the faces of the skin, and all surfaces are there at the end. Smoothing that is told to make all its
    iterations takes time for each. Source: `python -m benchmarks.expectations`, docs/benchmarks.md."""
    if process == "prepare":
        return _expect_chain(inputs, faces)
    need = _NEEDS.get(f"{process} by {inputs['mesher']}" if inputs.get("mesher") in SLOWER_MESHERS else process)
    if need is None:
        return UNKNOWN
    layers = len(inputs.get("layers") or ())
    surfaces, passes = layers + 1, float(max(layers, 1))
    if inputs.get("stop") == "iterations":
        passes *= max(float(inputs.get("iterations", DEFAULT_ITERATIONS)) / DEFAULT_ITERATIONS, 1.0)
    drawing_bytes = MB * (need.figures_mb + need.figures_mb_per_layer * layers)
    geometry_bytes = MB * LOADED_MB + need.bytes_per_face * faces * surfaces + need.bytes_per_face2 * faces**2
    memory_bytes = max(drawing_bytes, geometry_bytes)  # one comes after the other
    cpu_s = need.s + need.s_per_layer * layers + need.s_per_face * faces * passes
    return Expectation(memory_bytes=int(MARGIN * memory_bytes), cpu_s=round(cpu_s, 1))


def _expect_chain(inputs: Mapping[str, Any], faces: int) -> Expectation:
    """Of `prepare`: one step after the other, so the memory of the hungriest and the time of all. Inner tissues count as if every
    layer had their faces, too: what is skin and what tissue is not known here, and a chain rather waits for a larger host."""
    layers = len(inputs.get("layers") or ())
    steps = [] if inputs.get("heal") is None else [expect("heal", {}, faces)]
    thin = inputs.get("decimate")
    if thin is not None:
        steps.append(expect("decimate", {}, faces))
        faces = min(int(faces * float(thin.get("target_ratio") or 1.0)), int(thin.get("target_faces") or faces))
    needless = () if inputs.get("tissues") else ("separate",)
    chosen = [name for name in ("detach", "smooth", "separate") if inputs.get(name) is not None and name not in needless]
    steps += [expect(name, {}, faces) for name in chosen]
    steps.append(expect("shells" if inputs.get("ears") is None else "ears", inputs, faces))
    if inputs.get("tetrahedra") is not None:
        steps.append(expect("tetrahedralize", inputs["tetrahedra"], faces * (layers + 1)))
    cpu_s = [step.cpu_s for step in steps if step.cpu_s is not None]
    return Expectation(max(step.memory_bytes for step in steps), round(sum(cpu_s), 1))
