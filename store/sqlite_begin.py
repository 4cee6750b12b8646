"""Two processes that write to one SQLite file: who finds it locked looks again within a millisecond."""

from __future__ import annotations

import sqlite3
import time
from typing import cast

from sqlalchemy import Connection

FIRST_LOOK_S = 0.0005
LONGEST_LOOK_S = 0.005
KIND = 0xFF  # the lower byte of SQLite's codes


def begin_to_write(connection: Connection, patience_s: float) -> None:
    """BEGIN IMMEDIATE, as soon as the other writer is done. SQLite's own busy handler sleeps up to 0.1 s between two looks, and
    the other process writes meanwhile, and again.

    Raises OperationalError, as SQLAlchemy wraps it, if the turn does not come within `patience_s`."""
    driver = cast(sqlite3.Connection, connection.connection.dbapi_connection)
    driver.execute("PRAGMA busy_timeout=0")
    try:
        latest, wait_s = time.monotonic() + patience_s, FIRST_LOOK_S
        while _is_busy(driver):
            if time.monotonic() > latest:
                break
            time.sleep(wait_s)
            wait_s = min(1.25 * wait_s, LONGEST_LOOK_S)
        if not driver.in_transaction:
            connection.exec_driver_sql("BEGIN IMMEDIATE")  # whatever refused is said once more, in SQLAlchemy's words
    finally:
        driver.execute(f"PRAGMA busy_timeout={round(1000 * patience_s)}")


def _is_busy(driver: sqlite3.Connection) -> bool:
    """Begin, and True only if another writes."""
    try:
        driver.execute("BEGIN IMMEDIATE")
    except sqlite3.DatabaseError as error:
        return error.sqlite_errorcode & KIND == sqlite3.SQLITE_BUSY
    return False
