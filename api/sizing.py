"""What a job will need, asked before it is accepted: one that cannot end well is refused now, not after an hour."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from api.services import Services
from core.errors import LimitError
from core.schema.expectation import MARGIN, Expectation, expect
from store.job import MeshInput


def size_up(services: Services, process: str, inputs: Mapping[str, Any], meshes: Iterable[MeshInput]) -> Expectation:
    """Raises LimitError `job.too_large_for_memory` if even without any margin it needs more than a job may use."""
    faces = sum(mesh.faces or 0 for mesh in meshes)
    expectation = expect(process, inputs, faces)
    least_bytes, limit_bytes = int(expectation.memory_bytes / MARGIN), int(services.settings.job_memory_bytes)
    if least_bytes > limit_bytes:
        raise LimitError(
            "job.too_large_for_memory",
            f"'{process}' on {faces} faces needs about {least_bytes} bytes of memory; a job of this server may use {limit_bytes}",
            expected_bytes=least_bytes,
            limit_bytes=limit_bytes,
            faces=faces,
        )
    return expectation
