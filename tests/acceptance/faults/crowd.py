"""Several clients at once, with the patience of ours and then some: who was accepted keeps asking for what was made."""

from __future__ import annotations

import hashlib
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TypeVar

from integument import (
    ArgumentError,
    Client,
    DownloadCorruptError,
    JobDismissedError,
    JobFailedError,
    ProblemError,
    ServerError,
)

from tests.acceptance.faults.plan import CLIENTS, Plan
from tests.acceptance.faults.story import Story
from tests.acceptance.faults.workload import VARIANTS, Request

T = TypeVar("T")
PAUSE_S = 0.5
PATIENCE_S = 600.0
WATCHED = 4  # every fourth job is followed by its events, and fetched, while things break
TRANSIENT_CODES = frozenset({"storage.full", "storage.low", "internal.unexpected"})  # a person would press the button again


class Crowd:
    """`begin`, `join`, then look at `stories`; `refusals` counts the answers that came after all retries of the client."""

    def __init__(self, url: str, key: str, meshes: Mapping[str, bytes], plan: Plan, folder: Path) -> None:
        self._url = url
        self._key = key
        self._meshes = meshes
        self._folder = folder
        self._threads = [
            threading.Thread(target=self._send_all, args=([one for one in plan.requests if one.client == client],), daemon=True)
            for client in range(CLIENTS)
        ]
        self._watching = ThreadPoolExecutor(max_workers=CLIENTS)
        self._lock = threading.Lock()
        self._began = 0.0
        self.stories = {request.number: Story(request) for request in plan.requests}
        self.refusals: Counter[str] = Counter()
        self.errors: list[str] = []

    def begin(self) -> None:
        """The clock of the plan starts."""
        self._began = time.monotonic()
        for thread in self._threads:
            thread.start()

    @property
    def is_sending(self) -> bool:
        """Until every request was accepted, or given up."""
        return any(thread.is_alive() for thread in self._threads)

    def join(self) -> None:
        """Wait for those who send and for those who watch."""
        for thread in self._threads:
            thread.join()
        self._watching.shutdown()

    def client(self) -> Client:
        """A client of ours."""
        return Client(self._url, api_key=self._key, timeout_s=10.0, retries=3)

    def _send_all(self, requests: list[Request]) -> None:
        hrefs: dict[str, str] = {}
        with self.client() as client:
            for request in requests:
                time.sleep(max(0.0, self._began + request.at_s - time.monotonic()))
                story = self.stories[request.number]
                try:
                    self._send(client, story, hrefs)
                except Exception as error:  # noqa: BLE001 - told in the table, where it makes the run fail
                    self._note(f"request {request.number} was never accepted: {error!r}")

    def _send(self, client: Client, story: Story, hrefs: dict[str, str]) -> None:
        variant = VARIANTS[story.request.variant]
        if variant.mesh not in hrefs:
            data = self._meshes[variant.mesh]
            hrefs[variant.mesh] = self.insist(lambda: client.upload_mesh(data, name=variant.mesh)).href
        inputs = variant.bound(hrefs[variant.mesh])
        story.job = self.insist(lambda: client.execute(variant.process, inputs, idempotency_key=story.request.key)).id
        if story.request.dismissed_after_s is not None:
            self._watching.submit(self._dismiss, story)
        elif story.request.number % WATCHED == 0:
            self._watching.submit(self._watch, story)

    def insist(self, act: Callable[[], T]) -> T:
        """Again and again while it may help; raises the last error."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            try:
                return act()
            except ServerError as error:
                code = error.code if isinstance(error, ProblemError) else "no answer"
                with self._lock:
                    self.refusals[code] += 1
                if not (error.transient or code in TRANSIENT_CODES) or time.monotonic() > deadline:
                    raise
                time.sleep(PAUSE_S)

    def _dismiss(self, story: Story) -> None:
        with self.client() as client:
            time.sleep(story.request.dismissed_after_s or 0.0)
            try:
                self.insist(lambda: client.dismiss(story.job))
                story.dismissed = True
            except ArgumentError:  # it was finished already, or an answer to an earlier try was lost
                story.dismissed = True
            except Exception as error:  # noqa: BLE001 - told in the table, where it makes the run fail
                self._note(f"request {story.request.number} cannot be dismissed: {error!r}")

    def _watch(self, story: Story) -> None:
        seen: list[int] = []
        with self.client() as client:
            try:
                self.insist(lambda: client.wait(story.job, lambda event: seen.append(int(event.id))))
                self.fetch(client, story)
            except (JobFailedError, JobDismissedError):
                return
            except Exception as error:  # noqa: BLE001 - told in the table, where it makes the run fail
                self._note(f"request {story.request.number} cannot be followed: {error!r}")
                return
        for before, after in zip([0, *seen], seen, strict=False):
            if after != before + 1 and after != 1:  # 1: the stream was begun once more
                story.gaps.append(f"job {story.job}: event {after} after {before}")

    def fetch(self, client: Client, story: Story) -> None:
        """Download what the job made, and keep the digests."""
        if story.sha256:
            return
        fetched = {}
        for output in self.insist(lambda: client.results(story.job)).outputs:
            target = self._folder / f"{story.request.number}-{output}"
            try:
                self.insist(lambda output=output, target=target: client.download(story.job, output, target))  # type: ignore[misc]
            except DownloadCorruptError as error:
                fetched[output] = f"corrupt: {error}"
                continue
            fetched[output] = hashlib.sha256(target.read_bytes()).hexdigest()
            target.unlink()
        story.sha256 = fetched

    def _note(self, text: str) -> None:
        with self._lock:
            self.errors.append(text)
