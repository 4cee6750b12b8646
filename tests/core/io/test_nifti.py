"""Label volumes out of NIfTI files, and the files that hold none."""

from __future__ import annotations

import math
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError, InternalError, LimitError
from core.io.canonical_volume import load_volume, save_volume
from core.io.volume import find_volume_format, read_volume
from core.io.voxels import MOST_LABELS
from core.label_volume import LabelVolume
from tests.core.io.nifti_bytes import CODES, nifti, packed, two_boxes

OBLIQUE = np.array([[1.9, 0.3, -0.2, -90.0], [-0.35, 1.4, 0.25, 12.5], [0.2, -0.3, 2.9, 40.0], [0, 0, 0, 1]])


def read(data: bytes, tmp_path: Path, unit: Any = "mm") -> LabelVolume:
    path = tmp_path / "upload"
    path.write_bytes(data)
    return read_volume(path, unit)[0]


@pytest.mark.parametrize("kind", CODES)
@pytest.mark.parametrize(("version", "order", "pack"), [(1, "<", False), (1, ">", True), (2, "<", True), (2, ">", False)])
def test_labels_of_every_type_come_back(kind: str, version: int, order: str, pack: bool, tmp_path: Path) -> None:
    data = nifti(two_boxes().astype(kind), OBLIQUE, version=version, order=order)
    volume = read(packed(data) if pack else data, tmp_path)
    assert np.array_equal(volume.labels, two_boxes())
    assert volume.counts() == {1: 8, 7: 6}
    assert volume.affine == pytest.approx(OBLIQUE, rel=1e-6)
    assert find_volume_format(tmp_path / "upload") == "nifti"


def test_values_are_scaled_before_they_are_labels(tmp_path: Path) -> None:
    assert read(nifti(two_boxes(), OBLIQUE, slope=2.0, intercept=0.0), tmp_path).counts() == {2: 8, 14: 6}
    assert read(nifti(two_boxes(), OBLIQUE, slope=math.nan, intercept=3.0), tmp_path).counts() == {1: 8, 7: 6}
    with pytest.raises(InputError) as error:
        read(nifti(two_boxes(), OBLIQUE, slope=0.5, intercept=0.0), tmp_path)
    assert error.value.code == "volume.not_integer"


def test_a_quaternion_places_voxels(tmp_path: Path) -> None:
    half = math.sqrt(0.5)  # 90 degrees about z: i runs along y, j against x; a negative qfac turns k over
    data = nifti(two_boxes(), quaternion=(0.0, 0.0, half, 5.0, 6.0, 7.0), pixdim=(-1.0, 2.0, 3.0, 4.0))
    expected = [[0, -3, 0, 5], [2, 0, 0, 6], [0, 0, -4, 7], [0, 0, 0, 1]]
    assert read(data, tmp_path).affine == pytest.approx(np.array(expected), abs=1e-5)


def test_without_any_place_the_size_of_voxels_counts_and_it_is_said(tmp_path: Path) -> None:
    path = tmp_path / "upload"
    path.write_bytes(nifti(two_boxes(), pixdim=(1.0, 0.5, 1.0, 2.0), units=0, tail=b"more"))
    volume, findings, _name = read_volume(path, "cm")
    assert np.diag(volume.affine) == pytest.approx([5.0, 10.0, 20.0, 1.0])
    assert [finding.code for finding in findings] == ["volume.not_oriented", "nifti.unit_unknown", "volume.bytes_after"]


@pytest.mark.parametrize(("units", "scale"), [(1, 1000.0), (2, 1.0), (3, 0.001), (2 | 8, 1.0)])
def test_the_header_tells_the_unit(units: int, scale: float, tmp_path: Path) -> None:
    assert read(nifti(two_boxes(), OBLIQUE, units=units), tmp_path).affine[:3] == pytest.approx(scale * OBLIQUE[:3], rel=1e-6)


REFUSED: dict[str, tuple[str, bytes]] = {
    "4D": ("nifti.dimensions", nifti(np.ones((3, 3, 3, 2), dtype=np.uint8), OBLIQUE)),
    "no dimensions": ("nifti.dimensions", nifti(two_boxes(), OBLIQUE, dim=(0, 5, 6, 7))),
    "negative side": ("nifti.dimensions", nifti(two_boxes(), OBLIQUE, dim=(3, 5, -6, 7))),
    "one voxel": ("volume.one_voxel", nifti(np.ones((1, 1, 1), dtype=np.uint8), OBLIQUE)),
    "a sheet": ("volume.one_voxel", nifti(np.ones((4, 4, 1), dtype=np.uint8), OBLIQUE)),
    "fractions": ("volume.not_integer", nifti(two_boxes() * np.float32(0.5), OBLIQUE)),
    "not a number": ("volume.not_integer", nifti(np.where(two_boxes() == 7, np.float32(np.nan), np.float32(1)), OBLIQUE)),
    "negative": ("volume.label_range", nifti(-two_boxes().astype(np.int16), OBLIQUE)),
    "too high": ("volume.label_range", nifti(two_boxes().astype(np.int32) * 10_000, OBLIQUE)),
    "a picture": ("volume.not_labels", nifti(np.arange(12**3, dtype=np.int16).reshape(12, 12, 12), OBLIQUE)),
    "nothing": ("volume.no_labels", nifti(np.zeros((4, 4, 4), dtype=np.uint8), OBLIQUE)),
    "flat affine": ("volume.affine_singular", nifti(two_boxes(), np.diag([1.0, 1.0, 0.0, 1.0]))),
    "parallel axes": ("volume.affine_singular", nifti(two_boxes(), [[1, 1, 0, 0], [1, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])),
    "affine of NaN": ("volume.affine_singular", nifti(two_boxes(), np.full((4, 4), np.nan))),
    "colours": ("nifti.datatype", nifti(two_boxes(), OBLIQUE, datatype=128)),
    "bits": ("nifti.datatype", nifti(two_boxes(), OBLIQUE, bitpix=16)),
    "unit": ("nifti.unit", nifti(two_boxes(), OBLIQUE, units=5)),
    "pair": ("nifti.pair", nifti(two_boxes(), OBLIQUE, magic=b"ni1\0")),
    "mark": ("nifti.header", nifti(two_boxes(), OBLIQUE, magic=b"nope")),
    "offset": ("nifti.header", nifti(two_boxes(), OBLIQUE, offset=20)),
    "cut off": ("volume.truncated", nifti(two_boxes(), OBLIQUE)[:-1]),
    "header only": ("volume.truncated", nifti(two_boxes(), OBLIQUE)[:300]),
    "packed, cut off": ("volume.truncated", packed(nifti(two_boxes(), OBLIQUE))[:-9]),
    "packed, damaged": ("volume.truncated", packed(nifti(two_boxes(), OBLIQUE))[:-8] + bytes(8)),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_holds_no_labels_is_refused_by_name(name: str, tmp_path: Path) -> None:
    code, data = REFUSED[name]
    with pytest.raises(InputError) as error:
        read(data, tmp_path)
    assert error.value.code == code


def test_a_picture_and_labels_differ_by_how_many_values_there_are(tmp_path: Path) -> None:
    values = (np.arange(11**3) % (MOST_LABELS + 1)).reshape(11, 11, 11).astype(np.int16)
    assert len(read(nifti(values, OBLIQUE), tmp_path).counts()) == MOST_LABELS


def test_absurd_dimensions_are_refused_before_memory_is_asked_for(tmp_path: Path) -> None:
    bomb = nifti(two_boxes(), OBLIQUE, dim=(3, 32767, 32767, 32767))
    with pytest.raises(LimitError) as error:
        read(bomb, tmp_path)
    assert error.value.code == "volume.too_large"


def test_a_unit_that_the_header_denies_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        read(nifti(two_boxes(), OBLIQUE), tmp_path, "m")
    assert error.value.code == "volume.unit_differs"


def test_the_stored_form_keeps_every_number_and_tells_damage(tmp_path: Path) -> None:
    volume = LabelVolume.of(two_boxes().astype(np.uint16), OBLIQUE)
    path = tmp_path / "kept"
    save_volume(volume, path)
    kept = load_volume(path)
    assert np.array_equal(kept.labels, volume.labels)
    assert np.array_equal(kept.affine, volume.affine)
    data = path.read_bytes()
    for damaged in (data[:-1], data[:40], b"", zlib.compress(data), data[:60] + b"?" + data[61:]):
        path.write_bytes(damaged)
        with pytest.raises(InternalError) as error:
            load_volume(path)
        assert error.value.code == "canonical.corrupt"
