"""`python -m integument` is `integument`."""

import sys

from integument.cli import main

sys.exit(main())
