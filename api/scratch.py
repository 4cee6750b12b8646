"""Scratch space of a request whose answer is a file in it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from fastapi import Depends

from api.request_folder import request_folder
from api.services import ServicesDep


def scratch_folder(services: ServicesDep) -> Iterator[Path]:
    """There until the answer is out."""
    with request_folder(services.incoming_dir) as folder:
        yield folder


FolderDep = Annotated[Path, Depends(scratch_folder)]
