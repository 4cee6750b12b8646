"""The file of an upload in pieces, on a real disk."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest

from api.partial_file import partial_file
from core.errors import LimitError

CHUNKS = [bytes([number % 251]) * (1000 + number) for number in range(600)]
BYTES = b"".join(CHUNKS)


def test_chunks_stand_one_behind_the_other(tmp_path: Path) -> None:
    with partial_file(tmp_path, "one") as file:
        file.append(CHUNKS)
        file.append(CHUNKS[:3])
        assert file.path.read_bytes() == BYTES + b"".join(CHUNKS[:3])
        assert file.size == file.present


def test_what_the_kernel_takes_in_part_is_gone_on_with_until_the_disk_is_full(tmp_path: Path) -> None:
    room, (soft, hard) = len(BYTES) // 2, resource.getrlimit(resource.RLIMIT_FSIZE)
    with partial_file(tmp_path, "one") as file:
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, hard))
        try:
            with pytest.raises(LimitError, match=f"full after {room} bytes") as caught:
                file.append(CHUNKS)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        assert caught.value.code == "storage.full"
        assert file.path.read_bytes() == BYTES[:room]
        assert file.size == 0  # nothing of it counts
