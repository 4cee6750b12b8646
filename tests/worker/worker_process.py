"""Run as a program: a real worker whose children do what tests.worker.targets says. Settings come from the environment."""

from __future__ import annotations

import logging
import sys

from store.settings import Settings
from worker.service import run_worker

if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    sys.exit(run_worker(Settings(), target="tests.worker.targets:run"))
