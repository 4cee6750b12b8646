"""One target under atheris, until it crashes or its time is over: `python -m tests.fuzz.one TARGET CORPUS... -options`."""

from __future__ import annotations

import sys

import atheris

OURS = ("core.io", "core.package", "api")

if __name__ == "__main__":
    name = sys.argv.pop(1)
    with atheris.instrument_imports(include=list(OURS)):
        from tests.fuzz.targets import TARGETS
    atheris.Setup(sys.argv, TARGETS[name])
    atheris.Fuzz()
