"""`python -m server`: the embedded server without the client's command line."""

import argparse
import sys
from pathlib import Path

from server.serve import serve
from store.settings import default_data_dir


def main() -> int:
    """The same three options as `integument serve`."""
    parser = argparse.ArgumentParser(prog="python -m server", description="Run the embedded Integument server.")
    parser.add_argument("--data-dir", type=Path, default=default_data_dir(), help="folder of everything it keeps [%(default)s]")
    parser.add_argument("--host", default="127.0.0.1", help="address to listen on [%(default)s]")
    parser.add_argument("--port", type=int, default=8000, help="port to listen on, 0 for any free one [%(default)s]")
    options = parser.parse_args()
    return serve(data_dir=options.data_dir, host=options.host, port=options.port)


if __name__ == "__main__":
    sys.exit(main())
