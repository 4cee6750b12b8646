"""Tissues that must never become a package."""

from dataclasses import replace

import pytest

from core.errors import InternalError
from core.package.build import build_package
from core.package.requirements import require_packable
from tests.core.package.nested import report, tissues


def refusal(*changed):
    with pytest.raises(InternalError) as caught:
        require_packable(changed)
    return caught.value.code


@pytest.mark.parametrize("name", ["../evil", "a/b", "a:b", "", "a b", ".hidden", "x" * 65, "SKIN", "freespace", "skin\n"])
def test_names_that_are_no_file_names(name):
    assert refusal(tissues()[0], replace(tissues()[1], name=name)) == "package.name_refused"


def test_order_is_from_outside_inwards():
    skin, fat, body = tissues()
    assert refusal(fat, skin, body) == "package.not_nested"
    assert refusal(skin, replace(fat, enclosing="Skin")) == "package.not_nested"


def test_coordinates_that_stl_cannot_hold():
    skin = tissues()[0]
    moved = skin.mesh.with_vertices(skin.mesh.vertices + 1e-9)
    assert refusal(replace(skin, mesh=moved)) == "package.not_rounded"


def test_nothing_is_written_for_them(tmp_path):
    with pytest.raises(InternalError):
        build_package(tmp_path / "p.zip", tissues()[::-1], report(), ())
    assert list(tmp_path.iterdir()) == []
