"""Kill a writer of a blob with SIGKILL before each line it executes, and look at what it left: `python -m … FOLDER`.

Prints how often it was killed and how often the blob was there, whole, nevertheless. Own process: it forks."""

from __future__ import annotations

import hashlib
import os
import signal
import sys
from pathlib import Path
from types import FrameType
from typing import Any

import store.local_blobs
from store.blobs import CHUNK_BYTES
from store.local_blobs import LocalBlobs

DATA = os.urandom(2 * CHUNK_BYTES + 5)
NAME = hashlib.sha256(DATA).hexdigest()


def write_and_die(root: Path, source: Path, line_number: int) -> None:
    """Put `source`, but die before the given line of store/local_blobs.py, counted as executed."""
    executed = 0

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal executed
        if frame.f_code.co_filename != store.local_blobs.__file__:
            return None
        if event == "line":
            executed += 1
            if executed == line_number:
                os.kill(os.getpid(), signal.SIGKILL)
        return trace

    sys.settrace(trace)
    LocalBlobs(root).put_file(source)


def main() -> None:
    """One child per line, until one reaches the end."""
    folder = Path(sys.argv[1])
    source = folder / "source"
    source.write_bytes(DATA)
    line_number, whole = 0, 0
    while True:
        line_number += 1
        root = folder / str(line_number)
        child = os.fork()
        if child == 0:
            write_and_die(root, source, line_number)
            os._exit(0)
        _, status = os.waitpid(child, 0)
        if os.WIFEXITED(status):
            assert os.WEXITSTATUS(status) == 0
            break
        assert os.WTERMSIG(status) == signal.SIGKILL
        blobs = LocalBlobs(root)
        left = list(blobs.all())
        for blob in left:
            assert blob.sha256 == NAME
            assert blobs.path(NAME).read_bytes() == DATA
        whole += len(left)
        assert blobs.put_file(source).sha256 == NAME  # what was left stands in nobody's way
        blobs.sweep({NAME}, older_than_s=-1.0)
        files = [path.name for path in root.rglob("*") if path.is_file() and path.name != ".lock"]
        assert files == [NAME], files
    print(line_number - 1, whole)


if __name__ == "__main__":
    main()
