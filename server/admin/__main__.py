"""`python -m server.admin`: the admin commands without the client's command line."""

import sys

from server.admin.command import admin

if __name__ == "__main__":
    sys.exit(admin())
