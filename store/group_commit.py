"""Transactions of threads that ask at the same moment are one: the disk is waited for once for all of them.

Whoever comes first leads: while he waits for his turn to write, and for the disk, others gather; the first of them leads next."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextvars import Context, copy_context
from typing import Any, TypeVar

from sqlalchemy.exc import IntegrityError, SQLAlchemyError
from sqlalchemy.orm import Session

from store.database import Database

MOST = 64  # of one transaction
LAST = "~"  # after all names of workspaces: what locks rows of many
T = TypeVar("T")
Work = Callable[[Session], Any]


class _SpoiltError(Exception):
    """One of several failed, so none of them is written."""


class _Order:
    """What one thread wants done. `turn` is set when it is done, or when this thread is to lead."""

    def __init__(self, work: Work, lock_order: str) -> None:
        self.work = work
        self.lock_order = lock_order
        self.context: Context = copy_context()  # of the thread that asks: traces and log lines are its own
        self.turn = threading.Event()
        self.is_done = False
        self.result: Any = None
        self.error: BaseException | None = None

    def run(self, session: Session) -> Any:
        return self.context.run(self.work, session)

    def end(self, result: Any = None, error: BaseException | None = None) -> None:
        self.result, self.error, self.is_done = result, error, True


class GroupCommit:
    """Thread-safe."""

    def __init__(self, db: Database) -> None:
        self._db = db
        self._lock = threading.Lock()
        self._waiting: list[_Order] = []
        self._is_led = False

    def run(self, work: Callable[[Session], T], lock_order: str = "") -> T:
        """What `work` returns, once it is committed; what it raises, and then nothing of it is written.

        Those in one transaction run in the order of `lock_order`, the name of what they lock, or two processes could wait for
        each other. `work` may run twice, if another of its transaction failed: only the second time counts."""
        order = _Order(work, lock_order)
        with self._lock:
            self._waiting.append(order)
            leads, self._is_led = not self._is_led, True
        if not leads:
            order.turn.wait()
        if not order.is_done:
            self._lead()
        if order.error is not None:
            raise order.error
        result: T = order.result
        return result

    def _lead(self) -> None:
        orders: list[_Order] = []
        try:
            try:
                with self._db.session() as session:
                    session.connection()  # begins, and so waits for other processes that write
                    orders = self._gather()
                    results = _run_all(orders, session)
            except _SpoiltError:
                for order in orders:
                    self._run_alone(order)
            else:
                for order, result in zip(orders, results, strict=True):
                    order.end(result)
        except BaseException as error:  # noqa: BLE001 - each thread raises it; what became of the commit is not known: once is all
            orders = orders or self._gather()
            for order in orders:
                if not order.is_done:
                    order.end(error=error)
        finally:
            self._hand_over()
            for order in orders:
                order.turn.set()

    def _gather(self) -> list[_Order]:
        """All that wait, in the order of their locks. Called once the turn to write has come."""
        with self._lock:
            orders, self._waiting = self._waiting[:MOST], self._waiting[MOST:]
        return sorted(orders, key=lambda order: order.lock_order)

    def _run_alone(self, order: _Order) -> None:
        try:
            with self._db.session() as session:
                result = order.run(session)
            order.end(result)
        except BaseException as error:  # noqa: BLE001 - it is raised in the thread that asked
            order.end(error=error)

    def _hand_over(self) -> None:
        with self._lock:
            self._is_led = bool(self._waiting)
            following = self._waiting[0] if self._waiting else None
        if following is not None:
            following.turn.set()


def _run_all(orders: list[_Order], session: Session) -> list[Any]:
    """Raises _SpoiltError if one of several failed by itself, and the database is not at fault."""
    try:
        return [order.run(session) for order in orders]
    except Exception as error:
        is_absence = isinstance(error, SQLAlchemyError) and not isinstance(error, IntegrityError)
        if is_absence or len(orders) == 1:
            raise
        raise _SpoiltError from error
