"""A lab in which everything can be broken: two worker hosts, API, PostgreSQL, Valkey and an object store, all real."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from store.settings import Settings
from tests.acceptance.faults.gate import Gate, Gates
from tests.acceptance.faults.plan import HOSTS
from tests.acceptance.lab import Lab, lab
from tests.acceptance.member import Member
from tests.postgres import DURABLE, PostgresServer, running_postgres
from tests.seaweed import running_seaweed
from tests.valkey import ValkeyServer, running_valkey

CLOCK_FOLDER = Path(__file__).resolve().parent / "clock"
PLACES = ("api", *HOSTS)


@dataclass(frozen=True)
class Premises:
    """Everything a fault may touch. `direct` is how the run itself looks at the tables and blobs, past all gates."""

    folder: Path
    lab: Lab
    postgres: PostgresServer
    valkey: ValkeyServer
    store: Gate
    databases: Mapping[str, Gate]
    direct: Settings

    def member(self, host: str) -> Member:
        """API or worker."""
        return self.lab.members[host]

    def disk(self, host: str) -> Path:
        """The data folder of a host, a small disk of its own."""
        return self.folder / host

    def clock(self, host: str) -> Path:
        """Holds by how many seconds the clock of a host is off."""
        return clock_file(self.folder, host)


def clock_file(folder: Path, host: str) -> Path:
    """Beside the data folder: a full disk must not stop the clock."""
    return folder / f"{host}.clock"


@contextmanager
def premises(folder: Path, path: str, **variables: str) -> Iterator[Premises]:
    """Start it all, with `variables` for API and workers; `path` is the PYTHONPATH they have besides."""
    with (
        running_postgres(DURABLE) as postgres,
        running_valkey(keeps=True) as valkey,
        running_seaweed() as seaweed,
        Gates() as gates,
    ):
        database_url, blobs_url = postgres.new_database(), seaweed.new_bucket()
        database = database_url.rpartition("@/")[2].partition("?")[0]
        store = gates.open(("127.0.0.1", seaweed.port))
        databases = {host: gates.open(postgres.socket_path) for host in PLACES}

        def of_host(host: str) -> dict[str, str]:
            clock = clock_file(folder, host)
            clock.write_text("0")
            return {
                "INTEGUMENT_DATABASE_URL": f"postgresql://postgres@127.0.0.1:{databases[host].port}/{database}",
                "INTEGUMENT_BLOBS_URL": blobs_url.replace(f":{seaweed.port}/", f":{store.port}/"),
                "PYTHONPATH": f"{CLOCK_FOLDER}:{path}",
                "FAULTS_CLOCK": str(clock),
            }

        with lab(
            folder, database_url, valkey.url, blobs_url=blobs_url, hosts=len(HOSTS), of_host=of_host, **variables
        ) as there_is:
            direct = Settings(data_dir=folder / "looking", database_url=database_url, blobs_url=blobs_url)
            yield Premises(folder, there_is, postgres, valkey, store, databases, direct)
