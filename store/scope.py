"""What an API key allows."""

from __future__ import annotations

from enum import StrEnum


class Scope(StrEnum):
    """None includes another: a key of a monitor need not read meshes."""

    READ = "read"  # look at, follow and download what is in the workspace
    SUBMIT = "submit"  # upload, execute, dismiss, retry, delete in the workspace
    ADMIN = "admin"  # what concerns the server as a whole: its metrics
