"""`make fuzz`: coverage-guided, each target in a process of its own. `python -m tests.fuzz [--seconds N] [--seed N] [TARGET...]`.

What is found lies in out/fuzz/<target>/; a crash is minimised, kept in tests/fuzz/corpus/<target>/ and mended.
"""

from __future__ import annotations

import argparse
import platform
import re
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
OUT = ROOT / "out" / "fuzz"
RSS_MIB = 3072
SECONDS_PER_INPUT = 20
LARGEST_BYTES = 8192


@dataclass(frozen=True, slots=True)
class Row:
    """What one target went through."""

    target: str
    inputs: int
    seconds: float
    edges: int
    crashes: int


def main() -> int:
    """The number of targets that crashed."""
    from tests.fuzz.targets import TARGETS

    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--seconds", type=int, default=60, help="for each target")
    parser.add_argument("--seed", type=int, default=1, help="of the fuzzer's dice")
    parser.add_argument("targets", nargs="*", choices=[*TARGETS, []], metavar="TARGET", help=", ".join(TARGETS))
    asked = parser.parse_args()
    try:
        import atheris  # noqa: F401
    except ImportError:
        hint = "uv sync --frozen --group fuzz" if platform.machine() == "x86_64" else "atheris has wheels for x86_64 alone"
        print(f"atheris is not installed: {hint}", file=sys.stderr)
        return 1
    rows = [run(target, asked.seconds, asked.seed) for target in asked.targets or TARGETS]
    table = ["| target | inputs | seconds | edges | crashes |", "|---|---|---|---|---|"]
    table += [f"| {row.target} | {row.inputs:,} | {row.seconds:.0f} | {row.edges} | {row.crashes} |" for row in rows]
    print("\n".join(table))
    (OUT / "table.md").write_text("\n".join(table) + "\n")
    return sum(row.crashes > 0 for row in rows)


def run(target: str, seconds: int, seed: int) -> Row:
    """Fuzz one target for a while."""
    from tests.fuzz.seeds import corpus, seeds

    found, begin = OUT / target / "corpus", OUT / target / "seeds"
    for place in (found, begin):
        place.mkdir(parents=True, exist_ok=True)
    for number, seed_bytes in enumerate([*seeds(target), *(path.read_bytes() for path in corpus(target))]):
        (begin / str(number)).write_bytes(seed_bytes)
    before = artefacts(target)
    started = time.monotonic()
    command = [
        *(sys.executable, "-m", "tests.fuzz.one", target, str(found), str(begin)),
        *(f"-max_total_time={seconds}", f"-seed={seed}", f"-max_len={LARGEST_BYTES}", f"-rss_limit_mb={RSS_MIB}"),
        *(f"-timeout={SECONDS_PER_INPUT}", "-print_final_stats=1", f"-artifact_prefix={OUT / target}/"),
    ]
    log = OUT / target / "log"
    with log.open("w") as output:
        ended = subprocess.run(command, cwd=ROOT, stdout=output, stderr=subprocess.STDOUT, check=False)
    said = log.read_text(errors="replace")
    inputs, spent = (re.findall(pattern, said) for pattern in (r"number_of_executed_units:\s+(\d+)", r"in (\d+) second"))
    edges = re.findall(r"cov: (\d+)", said)
    crashes = len(artefacts(target) - before) or int(ended.returncode != 0)
    if crashes:
        print(f"{target}: see {log.relative_to(ROOT)}", file=sys.stderr)
    return Row(
        target,
        int(inputs[-1]) if inputs else 0,
        float(spent[-1]) if spent else time.monotonic() - started,
        int(edges[-1]) if edges else 0,
        crashes,
    )


def artefacts(target: str) -> set[Path]:
    """Inputs that crashed, hung or took too much memory."""
    return {path for kind in ("crash", "timeout", "oom") for path in (OUT / target).glob(f"{kind}-*")}


if __name__ == "__main__":
    sys.exit(main())
