"""What is kept of coarser meshes: by all that decides about them, bounded, those asked for last."""

from __future__ import annotations

import os
from pathlib import Path

from api.preview_cache import PreviewCache


def keep(cache: PreviewCache, folder: Path, name: str, size: int) -> bool:
    """Whether it had to be made."""
    made = []

    def make(path: Path) -> None:
        made.append(path)
        path.write_bytes(name[:1].encode() * size)

    target = folder / "export"
    cache.put_into(target, make, name)
    assert target.read_bytes() == name[:1].encode() * size
    target.unlink()
    return bool(made)


def test_what_is_kept_is_not_made_again(tmp_path: Path) -> None:
    cache = PreviewCache(tmp_path / "kept", 100)
    assert keep(cache, tmp_path, "a", 10)
    assert not keep(cache, tmp_path, "a", 10)
    assert keep(cache, tmp_path, "b", 10)


def test_those_not_asked_for_the_longest_go_first(tmp_path: Path) -> None:
    cache = PreviewCache(tmp_path / "kept", 100)
    for age, name in enumerate(("a", "b", "c")):
        keep(cache, tmp_path, name, 30)
        newest = max((tmp_path / "kept").iterdir(), key=lambda path: path.stat().st_mtime)
        os.utime(newest, (1000 + age, 1000 + age))
    assert not keep(cache, tmp_path, "a", 30)  # asked for now
    assert keep(cache, tmp_path, "d", 30)
    assert not keep(cache, tmp_path, "a", 30)
    assert keep(cache, tmp_path, "b", 30)
    assert sum(path.stat().st_size for path in (tmp_path / "kept").iterdir()) <= 100


def test_what_is_larger_than_all_room_is_not_kept(tmp_path: Path) -> None:
    cache = PreviewCache(tmp_path / "kept", 10)
    assert keep(cache, tmp_path, "a", 11)
    assert keep(cache, tmp_path, "a", 11)


def test_what_was_handed_out_stays_when_the_kept_one_goes(tmp_path: Path) -> None:
    cache = PreviewCache(tmp_path / "kept", 100)
    keep(cache, tmp_path, "a", 10)
    target = tmp_path / "mine"
    cache.put_into(target, lambda path: None, "a")
    for path in (tmp_path / "kept").iterdir():
        path.unlink()
    assert target.read_bytes() == b"a" * 10
