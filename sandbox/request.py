"""What the owner asks of the nursery: one datagram per child."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

from sandbox.limits import Limits

MAX_REQUEST_BYTES = 64 * 1024  # target, limits and a path; the payload travels apart, in a memfd


@dataclass(frozen=True, slots=True)
class Request:
    """Run `target` ("module:function") within `limits`, in the folder `scratch`; `readable`: inputs that lie elsewhere."""

    target: str
    limits: Limits
    scratch: str
    readable: tuple[str, ...] = ()
    must_be_confined: bool = False  # rather no work than work the kernel cannot lock in

    def encode(self) -> bytes:
        """The datagram; its file descriptors go along: event pipe, payload, status socket."""
        return json.dumps(asdict(self)).encode()

    @classmethod
    def decode(cls, datagram: bytes) -> Request:
        """The inverse of `encode`."""
        fields = json.loads(datagram)
        limits, readable = Limits(**fields.pop("limits")), tuple(fields.pop("readable"))
        return cls(limits=limits, readable=readable, **fields)
