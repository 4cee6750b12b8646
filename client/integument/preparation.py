"""The process `prepare` as a method of the client."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from integument.job import Job
from integument.layer import as_layer
from integument.surface_processes import MeshInput, OnEvent, Unit


class Preparation(ABC):
    """The whole way from a skin to a model in one job."""

    @abstractmethod
    def execute(self, process_id: str, inputs: Mapping[str, Any], *, idempotency_key: str | None = None) -> Job:
        """Queue a job."""

    @abstractmethod
    def wait(self, job: Job | str, on_event: OnEvent | None = None, *, timeout_s: float | None = None) -> Job:
        """Wait for its end."""

    @abstractmethod
    def _reference(self, mesh: MeshInput, unit: Unit) -> dict[str, str]: ...

    def prepare(
        self,
        skin: MeshInput,
        layers: Mapping[str, float | str] | None = None,
        *,
        tissues: Mapping[str, MeshInput] | None = None,
        ears: Literal["auto"] | Sequence[Mapping[str, Any]] | None = None,
        canals: Sequence[MeshInput] = (),
        unit: Unit = "mm",
        on_event: OnEvent | None = None,
        **inputs: Any,
    ) -> Job:
        """Heal, decimate, ears, layers, inner tissues, proof, tetrahedra, package; uploads what is needed, queues the job, waits.

        layers: as `shells`. tissues: name -> closed surface inside the innermost layer; ears: "auto", boxes as the server takes
        them, or None. canals: closed meshes of their air. Steps go by their names in the process description, with None to
        leave one out: `heal=None`, `decimate={"target_ratio": 0.5}`, `tetrahedra=None`.
        Outputs: `package`, `msh`, `vtu`, `steps`, `skin`, every layer and tissue under its name. A failed job has `steps` and
        the surfaces as its last finished step left them. Raises: as `upload_mesh`, `execute` and `wait`.
        """
        asked: dict[str, Any] = {"skin": self._reference(skin, unit), **inputs}
        if layers is not None:
            asked["layers"] = [as_layer(name, depth) for name, depth in layers.items()]
        if ears is not None:
            asked["ears"] = ears if isinstance(ears, str) else [dict(ear) for ear in ears]
        if canals:
            asked["canals"] = [self._reference(canal, unit) for canal in canals]
        if tissues:
            asked["tissues"] = [{"name": name, "mesh": self._reference(mesh, unit)} for name, mesh in tissues.items()]
        return self.wait(self.execute("prepare", asked), on_event)
