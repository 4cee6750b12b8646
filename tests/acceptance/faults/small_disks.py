"""Disks that can be filled: a tmpfs for each host, seen by this process and those it starts alone."""

from __future__ import annotations

import ctypes
import os
import shutil
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from sandbox.kernel import CLONE_NEWUSER, unshare

CLONE_NEWNS = 0x0002_0000  # <linux/sched.h>
MS_REC, MS_PRIVATE = 0x4000, 0x4_0000  # <linux/mount.h>
PIECE_BYTES = 1024 * 1024
FILLER = "filler"
INODES = 4000
NEEDED = (
    "the fault run mounts small disks in a namespace of its own, and this kernel refuses that: run it as root, or allow "
    "it with `sysctl kernel.unprivileged_userns_clone=1 kernel.apparmor_restrict_unprivileged_userns=0`"
)


def leave_mounts() -> None:
    """Move to mounts of our own. For a process with one thread; raises OSError with what is needed."""
    uid, gid = os.getuid(), os.getgid()
    try:
        unshare(CLONE_NEWNS)
    except PermissionError:
        try:
            unshare(CLONE_NEWUSER | CLONE_NEWNS)
        except OSError as error:
            raise OSError(error.errno, NEEDED) from error
        Path("/proc/self/setgroups").write_text("deny")
        Path("/proc/self/uid_map").write_text(f"{uid} {uid} 1")
        Path("/proc/self/gid_map").write_text(f"{gid} {gid} 1")
    _mount("none", "/", "", MS_REC | MS_PRIVATE, "")


def mount_small_disks(folders: Iterable[Path], size_bytes: int) -> None:
    """One for each folder. They go with the last process that sees them."""
    for folder in folders:
        folder.mkdir(parents=True, exist_ok=True)
        _mount("tmpfs", str(folder), "tmpfs", 0, f"size={size_bytes},nr_inodes={INODES},mode=700")


def fill(folder: Path) -> None:
    """Until no byte, no file and no folder more goes in."""
    filler = folder / FILLER
    filler.mkdir(exist_ok=True)
    handle = os.open(filler / "bytes", os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    try:
        for piece in (bytes(PIECE_BYTES), bytes(4096), b"\0"):
            with suppress(OSError):
                while True:
                    os.write(handle, piece)
    finally:
        os.close(handle)
    with suppress(OSError):
        for number in range(INODES):
            (filler / str(number)).touch()


def empty(folder: Path) -> None:
    """As before `fill`."""
    shutil.rmtree(folder / FILLER, ignore_errors=True)


def _mount(source: str, target: str, kind: str, flags: int, options: str) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mount(source.encode(), target.encode(), kind.encode(), ctypes.c_ulong(flags), options.encode()) != 0:
        raise OSError(ctypes.get_errno(), f"{NEEDED} (mount {target}: {os.strerror(ctypes.get_errno())})")
