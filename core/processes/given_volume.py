"""What a label volume holds, for the report of a job that could not use it: who asked for a wrong label sees which there are."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.errors import IntegumentError
from core.io.canonical_volume import load_volume
from core.label_volume import LabelVolume
from core.reports.wording import volume as volume_words
from core.reports.wording import whole

MOST_LABELS = 200


def given_volume(href: str, entries: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Voxels, their size and labels of the volume; nothing if it cannot be read."""
    try:
        return _told(load_volume(Path(entries[href]["path"])))
    except (IntegumentError, KeyError, OSError):
        return {}


def _told(volume: LabelVolume) -> dict[str, Any]:
    counts = volume.counts()
    labels = {
        str(label): f"{whole(count)} voxels, {volume_words(count * volume.voxel_mm3())}"
        for label, count in list(counts.items())[:MOST_LABELS]
    }
    return {
        "voxels": " × ".join(map(str, volume.labels.shape)),
        "voxel_mm": [round(float(side), 6) for side in volume.voxel_mm()],
        "labels": labels,
        **({"labels_not_shown": len(counts) - MOST_LABELS} if len(counts) > MOST_LABELS else {}),
    }
