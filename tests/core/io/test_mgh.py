"""Label volumes out of files of FreeSurfer, and the files that hold none."""

from __future__ import annotations

from pathlib import Path

import nibabel
import numpy as np
import pytest

from core.errors import InputError, LimitError
from core.io.volume import find_volume_format, read_volume
from core.label_volume import LabelVolume
from tests.core.io.mgh_bytes import CODES, mgh
from tests.core.io.nifti_bytes import nifti, packed, two_boxes

OBLIQUE = np.array([[1.9, 0.3, -0.2, -90.0], [-0.35, 1.4, 0.25, 12.5], [0.2, -0.3, 2.9, 40.0], [0, 0, 0, 1]])


def read(data: bytes, tmp_path: Path, name: str = "aseg.mgz") -> LabelVolume:
    path = tmp_path / "upload"
    path.write_bytes(data)
    return read_volume(path, "mm", name)[0]


@pytest.mark.parametrize("kind", CODES)
@pytest.mark.parametrize("ending", ["mgh", "mgz"])
def test_what_another_program_writes_comes_back_with_its_affine(kind: str, ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"aseg.{ending}"
    image = nibabel.MGHImage(two_boxes().astype(kind), OBLIQUE)
    image.to_filename(path)
    volume, findings, name = read_volume(path, "mm")
    assert (name, findings) == ("mgh", ())
    assert np.array_equal(volume.labels, two_boxes())
    assert volume.affine == pytest.approx(OBLIQUE, abs=1e-4)


def test_the_middle_of_the_volume_lies_where_the_header_says(tmp_path: Path) -> None:
    """5 x 6 x 7 voxels of 2 mm, conformed: i runs to the left, j down, k forward."""
    volume = read(mgh(two_boxes(), sides=(2.0, 2.0, 2.0), middle=(10.0, 20.0, 30.0), tail=bytes(40)), tmp_path)
    assert volume.affine == pytest.approx(np.array([[-2, 0, 0, 15], [0, 0, 2, 13], [0, -2, 0, 36], [0, 0, 0, 1]]))
    assert volume.places_mm(np.array([[2.5, 3.0, 3.5]])) == pytest.approx(np.array([[10.0, 20.0, 30.0]]))


def test_without_a_place_the_coronal_order_counts_and_it_is_said(tmp_path: Path) -> None:
    path = tmp_path / "upload"
    path.write_bytes(mgh(two_boxes(), sides=(9.0, 9.0, 9.0), placed=0))
    volume, findings, _name = read_volume(path, "mm")
    assert volume.affine[:3, :3] == pytest.approx(np.array([[-1, 0, 0], [0, 0, 1], [0, -1, 0]]))
    assert [finding.code for finding in findings] == ["volume.not_oriented"]


def test_content_goes_before_the_name(tmp_path: Path) -> None:
    path = tmp_path / "upload"
    for data, name, found in (
        (mgh(two_boxes()), "labels.nii.gz", "mgh"),
        (packed(mgh(two_boxes())), "", "mgh"),
        (nifti(two_boxes(), OBLIQUE), "labels.mgz", "nifti"),
        (mgh(two_boxes(), version=0x201), "labels.MGZ", "mgh"),  # newer files say what they are meant for
        (b"solid", "labels.mgh", "mgh"),
        (b"solid", "skin.stl", None),
        (bytes(400), "skin.stl", None),
        (mgh(two_boxes(), placed=7), "skin.stl", None),
        (b"", "labels.mgz", None),
    ):
        path.write_bytes(data)
        assert find_volume_format(path, name) == found, name


REFUSED: dict[str, tuple[str, bytes]] = {
    "frames": ("mgh.frames", mgh(two_boxes(), frames=3)),
    "version": ("mgh.header", mgh(two_boxes(), version=2)),
    "negative side": ("mgh.header", mgh(two_boxes(), shape=(5, -6, 7))),
    "too many per side": ("mgh.header", mgh(two_boxes(), shape=(1 << 20, 1, 1))),
    "sides of NaN": ("mgh.header", mgh(two_boxes(), sides=(float("nan"), 1.0, 1.0))),
    "sides of kilometres": ("mgh.header", mgh(two_boxes(), sides=(1e30, 1.0, 1.0))),
    "tensors": ("mgh.datatype", mgh(two_boxes(), code=6)),
    "unknown type": ("mgh.datatype", mgh(two_boxes(), code=99)),
    "no directions": ("volume.affine_singular", mgh(two_boxes(), axes=(0.0,) * 9)),
    "nowhere": ("volume.affine_singular", mgh(two_boxes(), middle=(float("inf"), 0.0, 0.0))),
    "flat voxels": ("volume.affine_singular", mgh(two_boxes(), sides=(1.0, 0.0, 1.0))),
    "fractions": ("volume.not_integer", mgh(two_boxes() * np.float32(0.5))),
    "negative": ("volume.label_range", mgh(-two_boxes().astype(np.int16))),
    "a picture": ("volume.not_labels", mgh(np.arange(12**3, dtype=np.int16).reshape(12, 12, 12))),
    "nothing": ("volume.no_labels", mgh(np.zeros((4, 4, 4), dtype=np.uint8))),
    "one voxel": ("volume.one_voxel", mgh(np.ones((1, 1, 1), dtype=np.uint8))),
    "cut off": ("volume.truncated", mgh(two_boxes())[:-1]),
    "header only": ("volume.truncated", mgh(two_boxes())[:100]),
    "packed, cut off": ("volume.truncated", packed(mgh(two_boxes()))[:-9]),
    "packed, tail damaged": ("volume.truncated", packed(mgh(two_boxes(), tail=bytes(500)))[:-8] + bytes(8)),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_holds_no_labels_is_refused_by_name(name: str, tmp_path: Path) -> None:
    code, data = REFUSED[name]
    with pytest.raises(InputError) as error:
        read(data, tmp_path)
    assert error.value.code == code


def test_absurd_sizes_are_refused_before_memory_is_asked_for(tmp_path: Path) -> None:
    with pytest.raises(LimitError) as error:
        read(mgh(two_boxes(), shape=(32_767, 32_767, 32_767)), tmp_path)
    assert error.value.code == "volume.too_large"


def test_another_unit_than_mm_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "upload"
    path.write_bytes(mgh(two_boxes()))
    with pytest.raises(InputError) as error:
        read_volume(path, "m")
    assert error.value.code == "volume.unit_differs"
