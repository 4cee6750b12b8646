"""The powers of root, all given up: a server that runs as root does not run its children as one."""

from __future__ import annotations

import ctypes
import errno
import os

from sandbox.kernel import PR_CAPBSET_DROP, set_process_flag

VERSION_3 = 0x20080522  # _LINUX_CAPABILITY_VERSION_3 of <linux/capability.h>: two words of 32 capabilities
LAST_POSSIBLE = 64

_LIBC = ctypes.CDLL(None, use_errno=True)


class _Header(ctypes.Structure):
    _fields_ = [("version", ctypes.c_uint32), ("pid", ctypes.c_int)]


class _Word(ctypes.Structure):
    _fields_ = [("effective", ctypes.c_uint32), ("permitted", ctypes.c_uint32), ("inheritable", ctypes.c_uint32)]


def drop_capabilities() -> None:
    """Of this process, for good: nothing it starts gets any back. Raises OSError."""
    for number in range(LAST_POSSIBLE):
        try:
            set_process_flag(PR_CAPBSET_DROP, number)
        except OSError as error:
            if error.errno == errno.EINVAL:  # behind the last one this kernel knows
                break
            if error.errno == errno.EPERM:  # we have none, so none can be had either: no_new_privs is set
                break
            raise
    header, words = _Header(VERSION_3, 0), (_Word * 2)()
    if _LIBC.capset(ctypes.byref(header), ctypes.byref(words)) != 0:
        raise OSError(ctypes.get_errno(), f"capset: {os.strerror(ctypes.get_errno())}")
