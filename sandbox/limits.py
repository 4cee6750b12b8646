"""How much one child may use."""

from __future__ import annotations

from dataclasses import dataclass

MIB = 1024**2
GIB = 1024**3


@dataclass(frozen=True, slots=True)
class Limits:
    """Hard bounds of one child; reaching any of them ends the child with a `limit.*` error."""

    memory_bytes: int = 8 * GIB  # resident in the child and all it started; its address space may grow by as much
    cpu_s: int = 3600  # summed over the child's threads
    file_bytes: int = 8 * GIB  # one file, and the scratch folder as a whole
    wall_s: float = 3600.0  # from spawn to the end
    open_files: int = 256
    forks: bool = False  # whether it may start other processes, by `fork` alone
