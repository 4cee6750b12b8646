"""A filter of system calls (seccomp): what a child never needs is answered with "not permitted".

A list of what is refused, not of what is allowed: numeric libraries change their calls with every version, and a call
nobody thought of must not end a job. Files are Landlock's matter;
this keeps the child from sockets, programs, processes and other processes.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct

from sandbox.kernel import PR_SET_PDEATHSIG, system_call
from sandbox.refused_calls import CLONE, CLONE3, ON_ITSELF_ONLY, PRCTL, PROCESSES, REFUSED, SECCOMP, Numbers

# <linux/audit.h>; the place of a machine in `Numbers`
MACHINES = {"x86_64": (0xC000_003E, 0), "aarch64": (0xC000_00B7, 1)}
SET_MODE_FILTER = 1
CLONE_THREAD = 0x0001_0000
X32_CALLS = 0x4000_0000  # the other way to call an x86_64 kernel, with other numbers

# <linux/filter.h>: load a word of seccomp_data, jump, answer
LOAD, JUMP_EQUAL, JUMP_AT_LEAST, JUMP_SET, ANSWER = 0x20, 0x15, 0x35, 0x45, 0x06
NUMBER_AT, MACHINE_AT, FIRST_ARGUMENT_AT = 0, 4, 16  # its lower half: both machines are little-endian
ALLOW, KILL_PROCESS, ERRNO = 0x7FFF_0000, 0x8000_0000, 0x0005_0000
NOT_PERMITTED, NOT_KNOWN = ERRNO | errno.EPERM, ERRNO | errno.ENOSYS


def can_filter_calls() -> bool:
    """Whether this machine's numbers are known here and its kernel takes filters."""
    machine = MACHINES.get(platform.machine())
    if machine is None:
        return False
    try:
        system_call(_number(SECCOMP, machine[1]) or 0, SET_MODE_FILTER, 0, 0)
    except OSError as error:
        return error.errno == errno.EFAULT  # it looked for the filter
    return True


def refuse_calls(*, forks: bool = False) -> bool:
    """Install the filter; False where there is none for this machine. `forks`: other processes may be started.

    For a process with no_new_privs; it lasts, and holds for whatever is started. Raises OSError."""
    machine = MACHINES.get(platform.machine())
    if machine is None:
        return False
    program = build_filter(*machine, own_pid=os.getpid(), forks=forks)
    instructions = ctypes.create_string_buffer(program, len(program))
    header = ctypes.create_string_buffer(struct.pack("HxxxxxxP", len(program) // 8, ctypes.addressof(instructions)))
    system_call(_number(SECCOMP, machine[1]) or 0, SET_MODE_FILTER, 0, ctypes.addressof(header))
    return True


def build_filter(machine: int, column: int, *, own_pid: int, forks: bool) -> bytes:
    """The program, 8 bytes per instruction."""
    lines = [
        _line(LOAD, MACHINE_AT),
        _line(JUMP_EQUAL, machine, 1, 0),
        _line(ANSWER, KILL_PROCESS),
        _line(LOAD, NUMBER_AT),
        _line(JUMP_AT_LEAST, X32_CALLS, 0, 1),
        _line(ANSWER, KILL_PROCESS),
    ]
    for numbers in (REFUSED | ({} if forks else PROCESSES)).values():
        lines += _when(_number(numbers, column), [_line(ANSWER, NOT_PERMITTED)])
    for numbers in ON_ITSELF_ONLY.values():  # 0 is oneself, but for `kill`, where it is one's group: the same here
        own = [_line(JUMP_EQUAL, 0, 2, 0), _line(JUMP_EQUAL, own_pid, 1, 0), _line(ANSWER, NOT_PERMITTED), _line(ANSWER, ALLOW)]
        lines += _when(_number(numbers, column), [_line(LOAD, FIRST_ARGUMENT_AT), *own])
    dying_with = [_line(JUMP_EQUAL, PR_SET_PDEATHSIG, 0, 1), _line(ANSWER, NOT_PERMITTED), _line(ANSWER, ALLOW)]
    lines += _when(_number(PRCTL, column), [_line(LOAD, FIRST_ARGUMENT_AT), *dying_with])
    if not forks:
        threads = [_line(JUMP_SET, CLONE_THREAD, 1, 0), _line(ANSWER, NOT_PERMITTED), _line(ANSWER, ALLOW)]
        lines += _when(_number(CLONE, column), [_line(LOAD, FIRST_ARGUMENT_AT), *threads])
        lines += _when(_number(CLONE3, column), [_line(ANSWER, NOT_KNOWN)])  # its flags are out of sight: back to `clone`
    return b"".join([*lines, _line(ANSWER, ALLOW)])


def _when(number: int | None, then: list[bytes]) -> list[bytes]:
    """`then` for this system call; nothing where the machine does not have it."""
    return [] if number is None else [_line(JUMP_EQUAL, number, 0, len(then)), *then]


def _line(code: int, operand: int, when_true: int = 0, when_false: int = 0) -> bytes:
    return struct.pack("HBBI", code, when_true, when_false, operand)


def _number(numbers: Numbers, column: int) -> int | None:
    return numbers[column]
