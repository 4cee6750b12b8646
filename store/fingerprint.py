"""What a request asks for, by content: the same process, inputs and bytes give the same fingerprint, whatever the links are."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from typing import Any

from store.job import MeshInput


def fingerprint_of(process: str, inputs: Mapping[str, Any], mesh_inputs: Iterable[MeshInput]) -> str:
    """SHA-256 in hexadecimal."""
    digests = {mesh.href: mesh.sha256 for mesh in mesh_inputs}
    asked = json.dumps([process, _by_content(inputs, digests)], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(asked.encode()).hexdigest()


def _by_content(value: Any, digests: Mapping[str, str]) -> Any:
    if isinstance(value, Mapping):
        href = value.get("href")
        if isinstance(href, str) and href in digests:
            return {"sha256": digests[href]}  # titles and media types beside the link change nothing
        return {key: _by_content(item, digests) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_by_content(item, digests) for item in value]
    return value
