"""`python -m worker`: one worker process, set up by INTEGUMENT_* variables. `python -m worker --check`: does it live?"""

from __future__ import annotations

import argparse
import logging
import sys

from store.settings import Settings
from worker.liveness import Liveness


def main() -> int:
    """0, or 1 where --check finds no living worker on this host."""
    parser = argparse.ArgumentParser(prog="python -m worker", description=__doc__)
    parser.add_argument("--check", action="store_true", help="only say, by exit code, whether the worker of this host lives")
    arguments = parser.parse_args()
    settings = Settings()
    if arguments.check:
        return 0 if Liveness(settings).is_fresh() else 1
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    from worker.service import run_worker

    return run_worker(settings)


if __name__ == "__main__":
    sys.exit(main())
