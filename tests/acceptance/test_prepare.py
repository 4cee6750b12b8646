"""`prepare` over HTTP: killed twice, child and worker, it goes on where it was; solvers' readers load what it made."""

from __future__ import annotations

import hashlib
import json
import re
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from io import BytesIO
from pathlib import Path
from typing import Any

import igl
import meshio
import psutil
import pytest
from integument import Client

from core.geometry.exact_intersection import find_intersecting_faces
from core.mesh import Mesh
from subjects.touching import arms_lowered, grown_together
from tests.acceptance.service import LIMIT_S, Service, read_stl, unpack_shells
from tests.embedded import Embedded, embedded
from tests.gmsh_reader import sizes_in_gmsh
from tests.organs import organs
from tests.package_readers import read_every_export
from tests.solids import sphere, together

LARGE_S = 1800.0  # for a third of a job on 107,000 faces
ARMPITS = [  # of the body with lowered arms; see docs/processes/detach.md
    {"name": "left_arm", "box_mm": {"min": [60, 330, -60], "max": [240, 450, 90]}},
    {"name": "right_arm", "box_mm": {"min": [-240, 330, -60], "max": [-60, 450, 90]}},
]


@pytest.fixture(scope="module")
def keeping(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Embedded]:
    """A server that keeps every step, however quick it was."""
    with embedded(tmp_path_factory.mktemp("prepare") / "data", {"INTEGUMENT_CHECKPOINT_AFTER_S": "0"}) as server:
        yield server


def ask(service: Service, skin: Mesh, inner: Mapping[str, Mesh], **asked: Any) -> str:
    """The id of a job of `prepare`."""
    tissues = [{"name": name, "mesh": {"href": service.upload(mesh, name)}} for name, mesh in inner.items()]
    return service.execute("prepare", {"skin": {"href": service.upload(skin)}, "tissues": tissues, **asked})


def step_lines(server: Embedded, job: str) -> list[tuple[str, bool]]:
    """Every line of the job's log that tells of a step: its name, and whether an attempt before had done it."""
    with Client(server.url) as client:
        said = [event.message for event in client.events(job, follow=False) if event.type == "log"]
    found = (re.match(r"step (\w+) done \((taken)?", line) for line in said)
    return [(one[1], one[2] is not None) for one in found if one]


def wait_for_progress(service: Service, job: str, percent: float, attempt: int, limit_s: float) -> None:
    """Until an attempt is that far."""
    service.wait(job, lambda status: status["attempt"] == attempt and status["progress"] >= percent, limit_s=limit_s)


def kill_worker(server: Embedded) -> None:
    """With all below it."""
    worker = server.part("worker")
    family = [worker, *worker.children(recursive=True)]
    worker.kill()
    _, alive = psutil.wait_procs(family, timeout=5)
    assert alive == []


def read_all(package: bytes, msh: bytes, vtu: bytes) -> dict[str, Any]:
    """Every export by its reader; raises what a reader raises. Returns the manifest."""
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(BytesIO(package)) as archive:
        archive.extractall(folder)
        manifest = read_every_export(Path(folder))
        assert (Path(folder) / "gmsh" / "volume.msh").read_bytes() == msh
        assert hashlib.sha256(msh).hexdigest() == manifest["files"]["gmsh/volume.msh"]["sha256"]
        (Path(folder) / "volume.vtu").write_bytes(vtu)
        by_gmsh = sizes_in_gmsh(Path(folder) / "gmsh" / "volume.msh", dimension=3)
        assert sum(by_gmsh.values()) == len(meshio.read(Path(folder) / "volume.vtu").cells_dict["tetra"])
    return manifest


def kill_twice(server: Embedded, service: Service, job: str, limit_s: float = LIMIT_S) -> None:
    """The child while it makes layers, then the worker while it proves them; the job ends ready, in its third attempt.

    limit_s: for each of the three."""
    wait_for_progress(service, job, 30, 1, limit_s)
    server.child_at_work(job).kill()
    wait_for_progress(service, job, 59, 2, limit_s)
    kill_worker(server)
    ended = service.succeed(job, limit_s=limit_s)
    assert (ended["attempt"], ended["verdict"]) == (3, "simulation_ready")


def check_steps(server: Embedded, service: Service, job: str, before_the_kills: Sequence[str]) -> dict[str, Any]:
    """No step was done twice, and those were not done again that were finished before; the record by step."""
    made = [name for name, taken in step_lines(server, job) if not taken]
    assert len(made) == len(set(made)), "a finished step was done again"
    record = {step["name"]: step for step in json.loads(service.result(job, "steps"))["steps"]}
    assert {name for name, step in record.items() if step["taken_from_attempt_before"]} >= set(before_the_kills)
    return record


def check_model(service: Service, job: str, names: Sequence[str]) -> dict[str, Any]:
    """No intersection over all tissues, a region for each, every export read by its reader; tissue -> what is around it."""
    package = service.result(job, "package")
    shells = unpack_shells(package)
    assert set(shells) == set(names)
    whole = together(*shells.values())
    assert len(find_intersecting_faces(whole.vertices, whole.faces)) == 0
    manifest = read_all(package, service.result(job, "msh"), service.result(job, "vtu"))
    assert set(service.report(job)["regions"]) == set(names)
    return {tissue["name"]: tissue["enclosing_tissue"] for tissue in manifest["tissues"]}


def test_killed_twice_it_loses_no_finished_step(keeping: Embedded) -> None:
    box = {"name": "tip", "box_mm": {"min": [35, -20, -20], "max": [65, 20, 20]}}
    inner = {"brain": sphere(20.0, 3), "white": sphere(10.0, 3), "eye": sphere(8.0, 3, at=(0.0, 0.0, 27.9))}
    with closing(Service(keeping.url)) as service:
        canal = {"href": service.upload(sphere(4.0, 3, at=(50.0, 0.0, 0.0)), "canal")}
        job = ask(service, sphere(50.0, 4), inner, ears=[box], canals=[canal], tetrahedra={"radius_edge": None})
        kill_twice(keeping, service, job)
        check_steps(keeping, service, job, ["heal", "tissues", "ears", "layers", "separate"])
        around = check_model(service, job, ["skin", "fat", "average_body", *inner])
        assert (around["white"], around["eye"]) == ("brain", "average_body")


@pytest.mark.slow
@pytest.mark.timeout(3 * LARGE_S)
@pytest.mark.parametrize("halvings", [0, 1], ids=["27k", "107k"])
def test_a_body_with_lowered_arms_canals_and_five_organs(tmp_path: Path, halvings: int) -> None:
    """The whole way on the real body: arms grown into the torso, both ears found; halvings: of the edges."""
    fused = grown_together(arms_lowered(40.0))
    finer = Mesh.of(*igl.upsample(fused.vertices, fused.faces, halvings)).rounded_to_float32() if halvings else fused
    inner = organs(4 + halvings)
    every_step = {"INTEGUMENT_CHECKPOINT_AFTER_S": "0"}  # those of less than a second, too
    with embedded(tmp_path / "data", every_step) as server, closing(Service(server.url)) as service:
        asked = {
            "detach": {"regions": ARMPITS, "gap_mm": 1.0},
            "smooth": {},
            "ears": "auto",
            "generate_canals": {},
        }
        job = ask(service, finer, inner, **asked)
        kill_twice(server, service, job, LARGE_S)
        record = check_steps(server, service, job, ["heal", "detach", "ears", "layers"])
        around = check_model(service, job, ["skin", "fat", "average_body", *inner])
        assert around["ventricles"] == "brain"
        assert {around[name] for name in ("brain", "heart", "left_lung", "right_lung")} == {"average_body"}
        assert record["detach"]["numbers"]["contacts"] == 2
        status = service.status(job)
        print(json.dumps({"peak_memory_bytes": status["peakMemoryBytes"], "timings_s": status["timings_s"], "steps": record}))


def test_a_failed_job_has_what_was_done_before(keeping: Embedded) -> None:
    with closing(Service(keeping.url)) as service:
        leave_and_look(service)


def test_a_corrected_request_takes_the_steps_before_the_change(keeping: Embedded) -> None:
    """Another request, another job; only what the change decides about is made."""
    inner = {"organ": sphere(10.0, 2), "other": sphere(10.0, 2, at=(19.0, 0.0, 0.0))}
    with closing(Service(keeping.url)) as service:
        failed = service.wait(ask(service, sphere(50.0, 3), inner, separate=None))
        assert failed["failure"]["code"] == "tissues.cross"
        job = ask(service, sphere(50.0, 3), inner, tetrahedra=None)
        assert service.succeed(job)["verdict"] == "simulation_ready"
        taken = dict(step_lines(keeping, job))
        assert taken == {"heal": True, "tissues": False, "layers": True, "separate": False, "validate": False}


HELD = {"name": "tip", "box_mm": {"min": [35, -20, -20], "max": [65, 20, 20]}}
FAILURES: dict[str, tuple[str, dict[str, Mesh], dict[str, Any]]] = {  # code -> step that fails, tissues, what is asked for
    "tissues.outside_skin": ("tissues", {"organ": sphere(10.0, 2, at=(60.0, 0.0, 0.0))}, {}),
    "canal.misses_skin": ("ears", {}, {"ears": [HELD], "canals": sphere(4.0, 2, at=(80.0, 0.0, 0.0))}),
    "detach.no_contact": ("detach", {}, {"detach": {"regions": [HELD]}}),
}


@pytest.mark.parametrize("code", FAILURES)
def test_whatever_fails_what_was_made_can_be_fetched(keeping: Embedded, code: str) -> None:
    failed, inner, asked = FAILURES[code]
    with closing(Service(keeping.url)) as service:
        if "canals" in asked:
            asked = {**asked, "canals": [{"href": service.upload(asked["canals"], "canal")}]}
        job = ask(service, sphere(50.0, 3), inner, **asked)
        ended = service.wait(job)
        assert (ended["status"], ended["failure"]["code"], ended["failure"]["class"]) == ("failed", code, "input")
        skin = read_stl(service.http.get(f"/v1/jobs/{job}/results/skin").content)
        assert len(skin.faces) == len(sphere(50.0, 3).faces)
        record = json.loads(service.http.get(f"/v1/jobs/{job}/results/steps").content)["steps"]
        steps = {step["name"]: step["outcome"] for step in record}
        assert (steps["heal"], steps[failed]) == ("done", "failed")
        assert service.report(job)["verdict"] == "not_ready"


def leave_and_look(service: Service) -> None:
    """A job that fails of its tissues."""
    inner = {"organ": sphere(10.0, 2), "other": sphere(10.0, 2, at=(15.0, 0.0, 0.0))}
    job = ask(service, sphere(50.0, 2), inner, separate=None)
    ended = service.wait(job)
    assert (ended["status"], ended["failure"]["code"], ended["failure"]["class"]) == ("failed", "tissues.cross", "input")
    fat = service.http.get(f"/v1/jobs/{job}/results/fat")
    assert fat.status_code == 200
    assert fat.headers["content-type"] == "model/stl"
    told = service.report(job)
    assert {step["name"]: step["outcome"] for step in told["steps"]} == {
        **dict.fromkeys(["heal", "tissues", "layers"], "done"),
        **dict.fromkeys(["decimate", "detach", "smooth", "ears", "separate"], "not_needed"),
        "validate": "failed",
        "tetrahedra": "not_reached",
    }
    assert {place["mesh"] for finding in told["findings"] for place in finding["places"]} == {"organ", "other"}
