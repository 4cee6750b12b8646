"""What is locked is not older than what known holes were mended in; `make audit` asks the advisory services for the rest."""

from __future__ import annotations

import tomllib

import h5py
import pytest
from packaging.version import Version

from tests.project.sources import ROOT

# distribution -> first version without, and which
FLOORS = {
    "fonttools": ("4.60.2", "CVE-2025-66034"),
    "h11": ("0.16.0", "CVE-2025-43859"),
    "jinja2": ("3.1.6", "CVE-2025-27516"),
    "pillow": ("11.3.0", "CVE-2025-48379"),
    "python-multipart": ("0.0.18", "CVE-2024-53981"),
    "requests": ("2.32.4", "CVE-2024-47081"),
    "starlette": ("1.5.1", "CVE-2025-54121, CVE-2025-62727, CVE-2026-48710, CVE-2026-54282, CVE-2026-54283, 100 ranges"),
    "urllib3": ("2.6.0", "CVE-2025-66418, CVE-2025-66471"),
}
HDF5_FLOOR = "2.0.0"  # CVE-2025-2926, -6269, -6750, -6816, -6856, -7067, -7069, -44905


@pytest.mark.parametrize("name", FLOORS)
def test_no_version_with_a_known_hole_is_locked(name: str) -> None:
    lock = tomllib.loads((ROOT / "uv.lock").read_text(encoding="utf-8"))
    versions = [Version(package["version"]) for package in lock["package"] if package["name"] == name]
    floor, holes = FLOORS[name]
    assert versions, f"{name} is not used any more: take its row away"
    assert min(versions) >= Version(floor), holes


def test_the_hdf5_that_reads_uploads_is_new_enough() -> None:
    assert Version(h5py.version.hdf5_version) >= Version(HDF5_FLOOR)
