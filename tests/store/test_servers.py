"""The servers the tests start are what they claim to be."""

from __future__ import annotations

import psycopg

from tests.postgres import PostgresServer
from tests.valkey import ValkeyServer


def test_postgres_gives_separate_empty_databases(postgres: PostgresServer) -> None:
    one, other = postgres.new_database(), postgres.new_database()
    assert one != other
    with psycopg.connect(one) as connection:
        (version,) = connection.execute("SHOW server_version_num").fetchone() or ("0",)
        (tables,) = connection.execute("SELECT count(*) FROM pg_tables WHERE schemaname = 'public'").fetchone() or (-1,)
    assert int(version) >= 170000
    assert tables == 0


def test_valkey_starts_again_at_the_same_address(valkey: ValkeyServer) -> None:
    first, url = valkey.process, valkey.url
    valkey.kill()
    assert first is not None
    assert first.poll() is not None
    valkey.start()
    assert valkey.url == url
    assert valkey.process is not first
