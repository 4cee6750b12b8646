"""`prepare` on hosts that share nothing but three URLs: one is killed with all its processes, the other goes on where it was."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import psutil
import pytest

from core.mesh import Mesh
from store.checkpoints import Checkpoints
from store.database import Database
from store.events import Events
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from subjects.touching import arms_lowered, grown_together
from tests.acceptance.lab import Lab, lab
from tests.acceptance.service import Service
from tests.acceptance.test_prepare import ARMPITS, ask, check_model
from tests.organs import organs
from tests.postgres import PostgresServer
from tests.seaweed import SeaweedServer
from tests.solids import sphere
from tests.valkey import ValkeyServer

SETTINGS = {"INTEGUMENT_LEASE_S": "15", "INTEGUMENT_RECONCILE_S": "1", "INTEGUMENT_CHECKPOINT_AFTER_S": "0"}
PATIENCE_S = 1800
LAYERS = "prepare: layers"


@dataclass(frozen=True)
class Scene:
    """A lab of two hosts, and its database to look into."""

    lab: Lab
    db: Database
    service: Service

    def keeps(self, job: str) -> set[str]:
        """The stages whose outputs are kept for a next attempt."""
        return {step.stage for step in Checkpoints(self.db, 0).of(id_of(job))}

    def holder(self, job: str) -> psutil.Process:
        """The worker that has it."""
        owner = Jobs(self.db).get(DEFAULT_WORKSPACE, id_of(job)).lease_owner
        assert owner is not None
        return psutil.Process(int(owner.rpartition(":")[2]))

    def steps(self, job: str) -> list[tuple[str, bool]]:
        """Of every step that was done: its name, and whether an attempt before had done it."""
        events = Events(self.db).after(DEFAULT_WORKSPACE, id_of(job), limit=10_000)
        said = (str(event.data["message"]) for event in events if event.type == "log")
        found = (re.match(r"step (\w+) done \((taken)?", line) for line in said)
        return [(one[1], one[2] is not None) for one in found if one]


def id_of(job: str) -> str:
    return job.rpartition("/")[2]


def kill_host(worker: psutil.Process) -> None:
    """With all its processes, as when its plug is pulled."""
    family = [worker, *worker.children(recursive=True)]
    for process in family:
        process.kill()
    _, alive = psutil.wait_procs(family[1:], timeout=20)  # the worker itself is waited for by whoever started it
    assert alive == []


def survive(scene: Scene, skin: Mesh, inner: Mapping[str, Mesh], kept: str, **asked: Any) -> str:
    """The job whose host was killed as soon as the stage `kept` was: ready in its second attempt, the same bytes as in peace."""
    job = ask(scene.service, skin, inner, **asked)
    deadline = time.monotonic() + PATIENCE_S
    while kept not in scene.keeps(job):
        assert time.monotonic() < deadline, scene.service.status(job)
        time.sleep(0.05)
    done = {name for name, _ in scene.steps(job)}
    killed = scene.holder(job)
    kill_host(killed)
    ended = scene.service.succeed(job, limit_s=PATIENCE_S)
    assert (ended["attempt"], ended["verdict"]) == (2, "simulation_ready")
    assert killed.pid in {process.pid for process in scene.lab.workers.values()}
    made = [name for name, taken in scene.steps(job) if not taken]
    assert len(made) == len(set(made)), "a finished step was done again"
    assert done <= {name for name, taken in scene.steps(job) if taken}, "what the dead host had done came from the store"
    again = ask(scene.service, skin, inner, **asked)
    assert scene.service.succeed(again, limit_s=PATIENCE_S)["attempt"] == 1
    first, second = (sha256(scene.service.result(one, "package")).hexdigest() for one in (job, again))
    assert first == second
    return job


@pytest.fixture
def scene(tmp_path: Path, postgres: PostgresServer, valkey: ValkeyServer, seaweed: SeaweedServer) -> Iterator[Scene]:
    """Two hosts."""
    database_url = postgres.new_database()
    with (
        lab(tmp_path, database_url, valkey.url, blobs_url=seaweed.new_bucket(), hosts=2, of_host=lambda _host: SETTINGS) as there,
        closing(Database(Settings(data_dir=tmp_path / "looking", database_url=database_url))) as db,
        closing(Service(there.url, there.key)) as service,
    ):
        yield Scene(there, db, service)


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_it_survives_the_kill_of_its_host(scene: Scene) -> None:
    inner = {"brain": sphere(20.0, 3), "white": sphere(10.0, 3)}
    job = survive(scene, sphere(50.0, 3), inner, LAYERS, tetrahedra={"radius_edge": None})
    around = check_model(scene.service, job, ["skin", "fat", "average_body", *inner])
    assert around["white"] == "brain"


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_the_real_body_survives_it_too(scene: Scene) -> None:
    """26,836 faces, arms grown into the torso, both ears found, five organs."""
    inner = organs(3)
    asked: dict[str, Any] = {
        "detach": {"regions": ARMPITS, "gap_mm": 1.0},
        "ears": "auto",
        "generate_canals": {},
        "tetrahedra": {"radius_edge": None},
    }
    job = survive(scene, grown_together(arms_lowered(40.0)), inner, LAYERS, **asked)
    check_model(scene.service, job, ["skin", "fat", "average_body", *inner])
    print(dict(scene.steps(job)))
