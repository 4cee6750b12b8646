"""One code path: the embedded set-up (SQLite, private Valkey) and the lab's (PostgreSQL, Valkey apart) give the same bytes."""

from contextlib import closing
from hashlib import sha256
from pathlib import Path

import pytest

from subjects.body import body
from tests.acceptance.conftest import MainJob
from tests.acceptance.lab import lab
from tests.acceptance.service import Service
from tests.postgres import PostgresServer
from tests.valkey import ValkeyServer


@pytest.mark.slow
def test_both_make_the_same_package(
    main_job: MainJob, service: Service, tmp_path: Path, postgres: PostgresServer, valkey: ValkeyServer
) -> None:
    with lab(tmp_path, postgres.new_database(), valkey.url) as there_is, closing(Service(there_is.url, there_is.key)) as there:
        job = there.shells(there.upload(body(0), "body"))
        there.succeed(job)
        assert sha256(there.result(job, "package")).hexdigest() == sha256(main_job.package).hexdigest()
        for output in ("report", "report_html", "skin", "fat", "average_body"):
            assert there.result(job, output) == service.result(main_job.job, output)
