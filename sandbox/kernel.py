"""The few Linux calls that Python 3.11 has no function for."""

from __future__ import annotations

import ctypes
import os
import platform
import struct
from contextlib import suppress

_LIBC = ctypes.CDLL(None, use_errno=True)

# <linux/prctl.h>
PR_SET_PDEATHSIG = 1
PR_SET_CHILD_SUBREAPER = 36
PR_CAPBSET_DROP = 24
PR_SET_NO_NEW_PRIVS = 38
# <linux/sched.h>
CLONE_NEWUSER = 0x1000_0000
CLONE_NEWNET = 0x4000_0000
SCHED_BATCH = 3
# <linux/sched/types.h>: size, policy, flags, niceness, priority, runtime, deadline, period
SCHED_ATTR = "IIQiIQQQ"
SCHED_SETATTR = {"x86_64": 314, "aarch64": 274}


def set_process_flag(option: int, value: int) -> None:
    """prctl(option, value); raises OSError."""
    if _LIBC.prctl(option, ctypes.c_ulong(value), ctypes.c_ulong(0), ctypes.c_ulong(0), ctypes.c_ulong(0)) != 0:
        raise OSError(ctypes.get_errno(), f"prctl({option}): {os.strerror(ctypes.get_errno())}")


def system_call(number: int, *arguments: int) -> int:
    """A system call the C library has no name for; raises OSError."""
    result: int = _LIBC.syscall(ctypes.c_long(number), *map(ctypes.c_long, arguments))
    if result < 0:
        raise OSError(ctypes.get_errno(), f"system call {number}: {os.strerror(ctypes.get_errno())}")
    return result


def unshare(flags: int) -> None:
    """Leave the namespaces named by `flags`; raises OSError where the kernel or the container forbids it."""
    if _LIBC.unshare(flags) != 0:
        raise OSError(ctypes.get_errno(), f"unshare({flags:#x}): {os.strerror(ctypes.get_errno())}")


def ask_for_turns(slice_ns: int) -> None:
    """How long this process would compute in one go among others (Linux 6.12; before it nothing changes): 0.1 to 100 ms.

    Source: <linux/sched/types.h>, sched_setattr(2). Does nothing where the machine's number of the call is not known."""
    number = SCHED_SETATTR.get(platform.machine())
    if number is None:
        return
    size = struct.calcsize(SCHED_ATTR)
    niceness = os.getpriority(os.PRIO_PROCESS, 0)
    attributes = ctypes.create_string_buffer(struct.pack(SCHED_ATTR, size, SCHED_BATCH, 0, niceness, 0, slice_ns, 0, 0), size)
    with suppress(OSError):  # a container's filter of system calls; it is a courtesy, no promise
        system_call(number, 0, ctypes.addressof(attributes), 0)
