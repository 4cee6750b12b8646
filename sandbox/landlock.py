"""Landlock: from the call on, a process reaches the files it was told, and nothing else of the host (Linux 5.13 and later).

It holds for root too, lasts for the life of the process and all it starts, and also keeps it from looking into, tracing
and (6.12) signalling processes that are not confined with it.
Source: <linux/landlock.h>, docs.kernel.org/userspace-api/landlock.html.
"""

from __future__ import annotations

import ctypes
import errno
import os
from collections.abc import Iterable
from pathlib import Path

from sandbox.kernel import system_call

CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446  # the same number on every machine
CREATE_RULESET_VERSION = 1
RULE_PATH_BENEATH = 1

READ_FILE, READ_FOLDER, WRITE_FILE = 1 << 2, 1 << 3, 1 << 1
REMOVE_FOLDER, REMOVE_FILE, MAKE_FOLDER, MAKE_FILE = 1 << 4, 1 << 5, 1 << 7, 1 << 8
REFER, TRUNCATE = 1 << 13, 1 << 14
READING = READ_FILE | READ_FOLDER
WRITING = (
    READING | WRITE_FILE | REMOVE_FOLDER | REMOVE_FILE | MAKE_FOLDER | MAKE_FILE | REFER | TRUNCATE
)  # no links, no devices, no sockets
OF_FILES = READ_FILE | WRITE_FILE | TRUNCATE  # what a rule for a single file may name

# what each version of the interface can handle: file rights, TCP rights (bind, connect), scopes (abstract sockets, signals)
FILE_RIGHTS = {1: (1 << 13) - 1, 2: (1 << 14) - 1, 3: (1 << 15) - 1, 4: (1 << 15) - 1, 5: (1 << 16) - 1}
TCP_SINCE, TCP_RIGHTS = 4, 0b11
SCOPES_SINCE, SCOPES = 6, 0b11


class _Ruleset(ctypes.Structure):
    _fields_ = [("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scopes", ctypes.c_uint64)]


class _PathBeneath(ctypes.Structure):
    _pack_ = 1
    _fields_ = [("allowed", ctypes.c_uint64), ("folder", ctypes.c_int32)]


def landlock_version() -> int:
    """Version of the kernel's interface; 0 where it has none or it is switched off."""
    try:
        return system_call(CREATE_RULESET, 0, 0, CREATE_RULESET_VERSION)
    except OSError as error:
        if error.errno in (errno.ENOSYS, errno.EOPNOTSUPP, errno.EPERM):  # the last: a container's filter of system calls
            return 0
        raise


def confine_files(readable: Iterable[Path], writable: Iterable[Path]) -> int:
    """Keep this process to these files and folders and what is below them; paths that are not there are left out.

    Returns the version in force; 0: the kernel cannot, and nothing is confined. For a process of one thread with no_new_privs.
    Raises OSError."""
    version = landlock_version()
    if version == 0:
        return 0
    handled = FILE_RIGHTS[min(version, max(FILE_RIGHTS))]
    ruleset = _Ruleset(
        handled, TCP_RIGHTS if version >= TCP_SINCE else 0, SCOPES if version >= SCOPES_SINCE else 0
    )  # kernels take a longer structure than they know as long as the rest is zero
    handle = system_call(CREATE_RULESET, ctypes.addressof(ruleset), ctypes.sizeof(ruleset), 0)
    try:
        for rights, paths in ((READING, readable), (WRITING, writable)):
            for path in paths:
                _allow(handle, path, rights & handled)
        system_call(RESTRICT_SELF, handle, 0)
    finally:
        os.close(handle)
    return version


def _allow(ruleset: int, path: Path, rights: int) -> None:
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        return
    try:
        rule = _PathBeneath(rights if path.is_dir() else rights & OF_FILES, place)
        system_call(ADD_RULE, ruleset, RULE_PATH_BENEATH, ctypes.addressof(rule), 0)
    finally:
        os.close(place)
