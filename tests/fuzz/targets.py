"""All targets: name -> what takes any bytes and may raise nothing."""

from __future__ import annotations

from tests.fuzz.headers import read_headers
from tests.fuzz.readers import READERS, Target
from tests.fuzz.requests import send_request

TARGETS: dict[str, Target] = {**READERS, "headers": read_headers, "requests": send_request}
