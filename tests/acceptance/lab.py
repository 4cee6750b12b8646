"""The lab set-up on one machine: the commands of docker-compose.yml beside a real PostgreSQL and a Valkey of its own."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from server.address import choose_port
from tests.acceptance.member import START_S, Member
from tests.project.compose import SECRETS, read_compose


@dataclass(frozen=True)
class Lab:
    """A running lab: where its API is, a key for it, and its programs by the name of their host."""

    url: str
    key: str
    members: Mapping[str, Member]

    @property
    def workers(self) -> Mapping[str, subprocess.Popen[bytes]]:
        """The processes of the workers."""
        return {host: member.process for host, member in self.members.items() if host != "api"}


@contextmanager
def lab(
    folder: Path,
    database_url: str,
    broker_url: str,
    *,
    blobs_url: str = "",
    hosts: int = 1,
    of_host: Callable[[str], Mapping[str, str]] = lambda _host: {},
    **variables: str,
) -> Iterator[Lab]:
    """Migrate, then run API and workers until all are healthy and to the end of the block.

    With `blobs_url` every process has a data folder of its own, as on hosts that share nothing but the three URLs.
    `of_host` gives the programs of one host variables of their own.
    """
    services = read_compose(SECRETS)["services"]
    port = choose_port("127.0.0.1", 0)
    # what only a network of containers has gets its counterpart here; everything else is as the file says
    here = {
        "INTEGUMENT_DATABASE_URL": database_url,
        "INTEGUMENT_BROKER_URL": broker_url,
        "INTEGUMENT_BLOBS_URL": blobs_url,
        **variables,
    }
    api_here = {"INTEGUMENT_HOST": "127.0.0.1", "INTEGUMENT_PORT": str(port)}

    def member(service: str, host: str) -> Member:
        data_dir = {"INTEGUMENT_DATA_DIR": str(folder / (host if blobs_url else "data"))}
        given = {**services[service]["environment"], **here, **data_dir, **(api_here if service == "api" else {})}
        kind, *check = services[service].get("healthcheck", {"test": ["CMD"]})["test"]
        assert kind == "CMD"
        here_check = [argument.replace("127.0.0.1:8000", f"127.0.0.1:{port}") for argument in check]
        return Member(folder, host, services[service]["command"], here_check, {**given, **of_host(host)})

    operator, key_log = member("migrate", "api"), folder / "key.log"
    migration = operator.run(services["migrate"]["command"], folder / "migrate.log")
    assert migration.wait(START_S) == 0, (folder / "migrate.log").read_text()
    make_key = ["python", "-m", "server.admin", "--json", "keys", "create"]
    assert operator.run(make_key, key_log).wait(START_S) == 0, key_log.read_text()
    key = json.loads(key_log.read_text().partition("}")[0] + "}")["key"]  # the note of stderr follows
    with ExitStack() as running:
        members = {}
        for service, host in (*(("worker", f"worker-{number}") for number in range(1, hosts + 1)), ("api", "api")):
            members[host] = member(service, host)
            members[host].start()
            running.callback(members[host].stop)
            members[host].await_health()
        yield Lab(f"http://127.0.0.1:{port}", key, members)
