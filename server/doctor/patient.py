"""What is looked at."""

from __future__ import annotations

from dataclasses import dataclass

from store.blobs import Blobs
from store.database import Database
from store.settings import Settings


@dataclass(frozen=True, slots=True)
class Patient:
    """One installation, seen from this host. `deep`: read every file there is."""

    settings: Settings
    db: Database
    blobs: Blobs
    deep: bool
