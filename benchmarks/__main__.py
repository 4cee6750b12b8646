"""`python -m benchmarks`: tables on standard output; ratios are what counts, seconds depend on the machine."""

from __future__ import annotations

import argparse
import sys

from benchmarks.corpus import run_corpus
from benchmarks.decimation import compare_decimation, compare_literal
from benchmarks.healing import compare_healing
from benchmarks.shells import compare, six_layers


def main() -> int:
    """Exit code 1 if a subject of a corpus did not end as it must, or healing or decimation fell behind its numbers."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--large", action="store_true", help="also the body of 428,096 faces and the largest of the corpus")
    parser.add_argument("--small", action="store_true", help="only the body of 26,756 faces and the quick part of the corpus")
    parser.add_argument("--no-peers", action="store_true", help="leave out what others make")
    parser.add_argument("--only", choices=("shells", "six", "corpus", "healing", "decimation"), help="one of the parts")
    chosen = parser.parse_args()
    levels = [0] if chosen.small else [0, 1, *([2] if chosen.large else [])]
    right = True
    if chosen.only in (None, "shells"):
        compare(levels, peers_at=None if chosen.no_peers else min(levels[-1], 1))
    if chosen.only in (None, "six"):
        six_layers(min(levels[-1], 1))
    if chosen.only in (None, "corpus"):
        costs = {"quick"} | (set() if chosen.small else {"normal"}) | ({"slow"} if chosen.large else set())
        right = run_corpus(costs)
    if chosen.only in (None, "healing"):
        right = compare_healing(quick=chosen.small, peers=not chosen.no_peers) and right
    if chosen.only in (None, "decimation"):
        right = compare_decimation(levels[-1], peers=not chosen.no_peers) and right
        compare_literal()
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main())
