"""Packages read back: what the files hold, or a named refusal."""

import json
import struct
import tempfile
import zipfile

import numpy as np
import pytest

from core.errors import InputError, LimitError
from core.package import entries
from core.package.build import build_package
from core.package.read import read_shells
from tests.core.package.nested import report, tissues


@pytest.fixture
def package(tmp_path):
    path = tmp_path / "package.zip"
    build_package(path, tissues(), report(), ())
    return path


def rewritten(package, change):
    """The package with its files {name: bytes} changed by a function."""
    with zipfile.ZipFile(package) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    change(files)
    other = package.with_name("other.zip")
    with zipfile.ZipFile(other, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return other


def test_round_trip_in_nesting_order(package):
    shells = read_shells(package)
    assert list(shells) == ["skin", "fat", "average_body"]
    for tissue in tissues():
        np.testing.assert_array_equal(shells[tissue.name].triangles(), tissue.mesh.triangles())
        assert len(shells[tissue.name].vertices) == len(tissue.mesh.vertices)


def test_one_flipped_bit_is_noticed(package):
    def flip(files):
        data = bytearray(files["stl/fat.stl"])
        data[100] ^= 1
        files["stl/fat.stl"] = bytes(data)

    with pytest.raises(InputError) as caught:
        read_shells(rewritten(package, flip))
    assert caught.value.code == "package.checksum_mismatch"
    assert caught.value.facts["name"] == "fat"


def remove_surface(files):
    del files["stl/fat.stl"]


def remove_manifest(files):
    del files["manifest.json"]


def break_json(files):
    files["manifest.json"] = files["manifest.json"][:-20]


def add_key(files):
    files["manifest.json"] = json.dumps({**json.loads(files["manifest.json"]), "surprise": 1}).encode()


@pytest.mark.parametrize("change", [remove_surface, remove_manifest, break_json, add_key], ids=lambda change: change.__name__)
def test_what_is_no_package_is_refused(package, change):
    with pytest.raises(InputError) as caught:
        read_shells(rewritten(package, change))
    assert caught.value.code == "package.corrupt"


def test_text_is_no_package(tmp_path):
    path = tmp_path / "package.zip"
    path.write_text("solid nothing")
    with pytest.raises(InputError) as caught:
        read_shells(path)
    assert caught.value.code == "package.corrupt"


def grow(files):
    """1 MB and a little of zeros takes 1 kB in the zip."""
    files["stl/fat.stl"] = bytes(entries.SMALL_BYTES + 1)


def lengthen_manifest(files):
    files["manifest.json"] += b" " * entries.LARGEST_TEXT_BYTES


@pytest.mark.parametrize("change", [grow, lengthen_manifest], ids=lambda change: change.__name__)
def test_a_bomb_is_refused_before_it_is_unpacked(package, change):
    with zipfile.ZipFile(package) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    change(files)
    bomb = package.with_name("bomb.zip")
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    with pytest.raises(LimitError) as caught:
        read_shells(bomb)
    assert caught.value.code == "package.too_large"


def test_a_zip_that_states_less_than_it_holds_gives_no_more_than_stated(package):
    data = bytearray(package.read_bytes())
    with zipfile.ZipFile(package) as archive:
        name = b"stl/fat.stl"
        size = archive.getinfo(name.decode()).file_size
    place = data.rindex(name) - 46  # the entry of the directory at the end
    assert data[place : place + 4] == b"PK\x01\x02"
    assert struct.unpack_from("<I", data, place + 24) == (size,)
    struct.pack_into("<I", data, place + 24, 100)
    package.write_bytes(data)
    with pytest.raises(InputError) as caught:
        read_shells(package)
    assert caught.value.code in {"package.corrupt", "package.checksum_mismatch"}


def test_too_many_files_are_refused(package, monkeypatch):
    monkeypatch.setattr(entries, "MOST_ENTRIES", 5)
    with pytest.raises(LimitError) as caught:
        read_shells(package)
    assert caught.value.code == "package.too_large"


def test_a_broken_disk_is_not_the_fault_of_the_package(package, monkeypatch):
    """Here a scratch folder that is none."""
    monkeypatch.setattr(tempfile, "tempdir", "/dev/full")
    with pytest.raises(OSError, match="/dev/full"):
        read_shells(package)
