"""The life of one forked child: confine, load the payload, run the target, say how it ended."""

from __future__ import annotations

import errno
import importlib
import json
import logging
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

from core.errors import IntegumentError, InternalError, LimitError
from sandbox.channel import Channel
from sandbox.confinement import EVENTS_FD, keep_only, release_reserve, restrict
from sandbox.limits import Limits
from sandbox.messages import Message
from sandbox.request import Request
from sandbox.survey import not_confined

logger = logging.getLogger(__name__)  # written to the child's own log

Target = Callable[[dict[str, Any], Channel], dict[str, Any]]


def run_child(request: Request, events: int, payload: int) -> NoReturn:
    """Never returns: the copy of the nursery that called this ends here, whatever happens."""
    try:
        parcel = _read_all(payload)
        keep_only(events, Path(request.scratch))
        channel = Channel(EVENTS_FD)
        channel.send_last(_attempt(request, parcel, channel))
        code = 0
    except BaseException:  # there is nobody above us: what could not be sent goes to the log
        logger.exception("the child cannot report")
        code = 1
    finally:
        try:
            sys.stdout.flush()
            sys.stderr.flush()
        finally:  # a full log must not let the copy of the nursery live on
            os._exit(code)


def _attempt(request: Request, parcel: bytes, channel: Channel) -> Message:
    """The last message: the target's result, or the error that says why there is none."""
    try:
        missing = restrict(request.limits, Path(request.scratch), map(Path, request.readable), request.target)
        if missing and request.must_be_confined:
            raise not_confined(missing)
        result = _load(request.target)(json.loads(parcel), channel)
        message: Message = {"kind": "result", "result": result}
        json.dumps(message, allow_nan=False)
        return message
    except MemoryError as error:
        release_reserve()
        logger.exception("out of memory")
        return _failure(out_of_memory(request.limits, str(error)))
    except IntegumentError as error:
        return _failure(error)
    except OSError as error:
        logger.exception("stopped")
        return _failure(_explain_os_error(error, request.limits))
    except BaseException as error:  # also SystemExit and KeyboardInterrupt: no way out but this one
        logger.exception("stopped")
        return _failure(_unexpected(error))


def _load(target: str) -> Target:
    module, _, function = target.partition(":")
    loaded: Target = getattr(importlib.import_module(module), function)
    return loaded


def _failure(error: IntegumentError) -> Message:
    return {"kind": "error", "error": error.describe(), "outputs": error.outputs}


def out_of_memory(limits: Limits, detail: str = "") -> LimitError:
    """The error for a child that wanted more than `limits.memory_bytes`."""
    gib = limits.memory_bytes / 1024**3
    return LimitError(
        "limit.memory",
        f"the work needs more than the {gib:.2f} GiB of memory this server allows for one job"
        + (f" ({detail})" if detail else ""),
        limit_bytes=limits.memory_bytes,
    )


def file_too_large(limits: Limits) -> LimitError:
    """The error for a child that wrote more than `limits.file_bytes`."""
    return LimitError(
        "limit.file_size",
        f"the work writes more than the {limits.file_bytes / 1024**3:.2f} GiB of files this server allows for one job",
        limit_bytes=limits.file_bytes,
    )


def _explain_os_error(error: OSError, limits: Limits) -> IntegumentError:
    if error.errno == errno.EFBIG:
        return file_too_large(limits)
    if error.errno == errno.ENOMEM:
        return out_of_memory(limits, str(error))
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return LimitError("storage.full", "the server's disk is full; nothing of the input is at fault")
    return _unexpected(error)


def _unexpected(error: BaseException) -> InternalError:
    kind = type(error).__name__
    return InternalError("child.raised", f"the work stopped at an error nobody foresaw: {kind}: {error}", exception=kind)


def _read_all(descriptor: int) -> bytes:
    os.lseek(descriptor, 0, os.SEEK_SET)
    with os.fdopen(os.dup(descriptor), "rb") as payload:
        return payload.read()
