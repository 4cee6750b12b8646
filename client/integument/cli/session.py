"""The server of this call, and the screen."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from integument.api_key import read_key_file
from integument.cli.progress import ProgressView, choose_view
from integument.cli.screen import Screen
from integument.client import Client
from integument.embedded import EmbeddedServer


@dataclass(frozen=True, slots=True)
class JobWords:
    """What people call the job that is asked for."""

    name: str | None = None
    labels: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Options:
    """What holds for every command."""

    server: str | None
    screen: Screen
    key_file: Path | None = None
    words: JobWords = JobWords()

    def api_key(self) -> str | None:
        """Of --key-file; without it the client looks at INTEGUMENT_API_KEY. Raises: ArgumentError."""
        return None if self.key_file is None else read_key_file(self.key_file)

    def progress_view(self) -> ProgressView:
        """A fresh one."""
        return choose_view(self.screen.errors, as_json=self.screen.as_json, quiet=self.screen.quiet)


@dataclass(frozen=True, slots=True)
class Session:
    """A client, and whether its server goes when this call ends."""

    client: Client
    ends_with_call: bool


@contextmanager
def connect(options: Options) -> Iterator[Session]:
    """The server named by --server or INTEGUMENT_URL, else an embedded one for this call.

    Raises: ServerNotInstalledError, ServerStartError, ArgumentError (no address).
    """
    if options.server:
        with Client(options.server, api_key=options.api_key()) as client:
            yield Session(client, ends_with_call=False)
        return
    key = options.api_key()
    server = EmbeddedServer()
    if server.folder.running_url() is None:
        options.screen.note(f"No server is configured; using an embedded one with its data in {server.folder.path}.")
    with server, Client(server.url, api_key=key) as client:
        yield Session(client, ends_with_call=server.started_here)
