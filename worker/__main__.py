"""`python -m worker`: one worker process, set up by INTEGUMENT_* variables. `python -m worker --check`: does it live?"""

from __future__ import annotations

import argparse
import sys

from core.errors import IntegumentError
from sandbox.log_lines import configure_logging
from sandbox.survey import survey_confinement
from store.redaction import Redaction
from store.settings import Settings
from store.telemetry import start_telemetry, stop_telemetry
from worker.liveness import Liveness


def main() -> int:
    """0; 1 where --check finds no living worker on this host; 2 if the host cannot do what the settings ask."""
    parser = argparse.ArgumentParser(prog="python -m worker", description=__doc__)
    parser.add_argument("--check", action="store_true", help="only say, by exit code, whether the worker of this host lives")
    arguments = parser.parse_args()
    settings = Settings()
    if arguments.check:
        return 0 if Liveness(settings).is_fresh() else 1
    configure_logging(settings.log_format, Redaction.of(settings))
    try:
        survey_confinement(required=settings.require_confinement)
        start_telemetry("worker")
    except IntegumentError as error:
        print(f"python -m worker: {error}", file=sys.stderr)
        return 2
    from worker.service import run_worker

    try:
        return run_worker(settings)
    finally:
        stop_telemetry()


if __name__ == "__main__":
    sys.exit(main())
