"""Packages read back: what the files hold, or a named refusal."""

import json
import zipfile

import numpy as np
import pytest

from core.errors import InputError
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
