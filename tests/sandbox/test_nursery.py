from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from core.errors import InternalError
from sandbox.call import call
from sandbox.descendants import children_of
from sandbox.limits import Limits
from sandbox.nursery import Nursery
from tests.sandbox.ending import wait_for_end

TARGETS = "tests.sandbox.targets:"
ROOT = Path(__file__).parents[2]


@pytest.fixture
def own_nursery() -> Iterator[Callable[..., Nursery]]:
    made: list[Nursery] = []

    def make(*preload: str, ready_timeout_s: float = 60.0) -> Nursery:
        made.append(Nursery(preload, ready_timeout_s=ready_timeout_s))
        return made[-1]

    yield make
    for nursery in made:
        nursery.stop()


def test_a_lost_nursery_takes_its_children_along_and_is_replaced(
    own_nursery: Callable[..., Nursery], limits: Limits, scratch: Path
) -> None:
    nursery = own_nursery()
    with nursery.spawn(TARGETS + "sleep", {"seconds": 60}, limits, scratch) as child:
        child.events(10.0)
        assert nursery.pid is not None
        os.kill(nursery.pid, signal.SIGKILL)
        assert wait_for_end([nursery.pid, child.pid]) == []
        child.events(1.0)
        outcome = child.outcome()
        assert outcome is not None
        assert outcome.error is not None
        assert outcome.error.code == "nursery.lost"
    assert call(nursery, TARGETS + "echo", {"again": True}, limits, scratch) == {"again": True}


def test_a_killed_owner_leaves_nothing_behind(tmp_path: Path) -> None:
    source = f"""
import sys, time
from pathlib import Path
from sandbox.limits import Limits
from sandbox.nursery import Nursery
nursery = Nursery(())
child = nursery.spawn("{TARGETS}leave_grandchildren", {{"wait": True}}, Limits(forks=True), Path({str(tmp_path)!r}))
print(nursery.pid, child.pid, child.events(10.0)[0]["message"], flush=True)
time.sleep(60)
"""
    with subprocess.Popen([sys.executable, "-c", source], stdout=subprocess.PIPE, text=True, cwd=ROOT) as owner:
        assert owner.stdout is not None
        pids = [int(pid) for pid in owner.stdout.readline().split()]
        assert len(pids) == 5
        owner.kill()
    assert wait_for_end(pids) == []


def test_a_killed_owner_ends_a_nursery_that_is_still_loading(tmp_path: Path) -> None:
    (tmp_path / "slow_to_load.py").write_text("import time\ntime.sleep(60)\n")
    source = """
import time
from sandbox.nursery import Nursery
nursery = Nursery(("slow_to_load",))
nursery.start()
print(nursery.pid, flush=True)
time.sleep(60)
"""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    with subprocess.Popen([sys.executable, "-c", source], stdout=subprocess.PIPE, text=True, env=environment) as owner:
        assert owner.stdout is not None
        pid = int(owner.stdout.readline())
        time.sleep(0.5)  # let it get into the import
        owner.kill()
    assert wait_for_end([pid]) == []


def test_stop_ends_running_children(own_nursery: Callable[..., Nursery], limits: Limits, scratch: Path) -> None:
    nursery = own_nursery()
    child = nursery.spawn(TARGETS + "sleep", {"seconds": 60}, limits, scratch)
    pids = [child.pid, nursery.pid or 0]
    nursery.stop()
    assert wait_for_end(pids, 0.0) == []
    child.close()
    assert nursery.pid is None


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("raise RuntimeError('no library')", "RuntimeError: no library"),
        ("import absent_module", "absent_module"),
        ("def warm_up():\n    raise SystemExit('no kernel')", "no kernel"),
    ],
)
def test_a_failed_preload_is_said_at_every_spawn(
    own_nursery: Callable[..., Nursery],
    limits: Limits,
    scratch: Path,
    monkeypatch: pytest.MonkeyPatch,
    source: str,
    words: str,
) -> None:
    (scratch / "broken_preload.py").write_text(source + "\n")
    monkeypatch.syspath_prepend(scratch)
    nursery = own_nursery("broken_preload")
    for _ in range(2):
        with pytest.raises(InternalError, match=words) as raised:
            nursery.spawn(TARGETS + "echo", {}, limits, scratch)
        assert raised.value.code == "nursery.preload_failed"
    (scratch / "broken_preload.py").write_text("def warm_up():\n    print('warm')\n")
    assert call(nursery, TARGETS + "echo", {"mended": 1}, limits, scratch) == {"mended": 1}


def test_warm_up_runs_once_before_the_children(
    own_nursery: Callable[..., Nursery], limits: Limits, scratch: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (scratch / "warm_module.py").write_text(
        "import os\nwarmed_by = []\ndef warm_up():\n    warmed_by.append(os.getpid())\n"
        "def tell(payload, channel):\n    return {'warmed_by': warmed_by}\n"
    )
    monkeypatch.syspath_prepend(scratch)
    nursery = own_nursery("warm_module")
    for _ in range(2):
        assert call(nursery, "warm_module:tell", {}, limits, scratch) == {"warmed_by": [nursery.pid]}


def test_a_preload_without_end_does_not_hold_the_caller_for_ever(
    own_nursery: Callable[..., Nursery], limits: Limits, scratch: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (scratch / "endless_preload.py").write_text("import time\ntime.sleep(60)\n")
    monkeypatch.syspath_prepend(scratch)
    nursery = own_nursery("endless_preload", ready_timeout_s=0.5)
    with pytest.raises(InternalError) as raised:
        nursery.spawn(TARGETS + "echo", {}, limits, scratch)
    assert raised.value.code == "nursery.not_ready"
    assert nursery.pid is None


def test_many_threads_may_spawn_at_once(nursery: Nursery, limits: Limits, tmp_path: Path) -> None:
    results: dict[int, dict[str, object]] = {}

    def work(number: int) -> None:
        folder = tmp_path / str(number)
        folder.mkdir()
        results[number] = call(nursery, TARGETS + "echo", {"number": number}, limits, folder)

    threads = [threading.Thread(target=work, args=(number,)) for number in range(16)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == {number: {"number": number} for number in range(16)}


def test_no_descriptor_is_left_open(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    call(nursery, TARGETS + "echo", {}, limits, scratch)
    before = [len(os.listdir(f"/proc/{pid}/fd")) for pid in (os.getpid(), nursery.pid)]
    for _ in range(5):
        call(nursery, TARGETS + "echo", {}, limits, scratch)
        with pytest.raises(InternalError):
            call(nursery, TARGETS + "segfault", {}, limits, scratch)
    after = [len(os.listdir(f"/proc/{pid}/fd")) for pid in (os.getpid(), nursery.pid)]
    assert all(now - then <= 1 for now, then in zip(after, before, strict=True))  # it may just be closing the last one


LEISURE = """
import os, time
warmed_by, learnt_by = [], []
def warm_up(): warmed_by.append(os.getpid())
def learn(): learnt_by.append(os.getpid())
def fail(): raise ValueError("no such step")
def leisure_steps(): return (fail, learn)
def tell(payload, channel): return {"warmed_by": warmed_by, "learnt_by": learnt_by}
"""


def test_what_is_not_needed_at_once_is_learnt_between_requests(
    own_nursery: Callable[..., Nursery], limits: Limits, scratch: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (scratch / "leisurely.py").write_text(LEISURE)
    monkeypatch.syspath_prepend(scratch)
    nursery = own_nursery("leisurely")
    latest = time.monotonic() + 20
    while not (told := call(nursery, "leisurely:tell", {}, limits, scratch))["learnt_by"] and time.monotonic() < latest:
        time.sleep(0.05)
    assert told == {"warmed_by": [nursery.pid], "learnt_by": [nursery.pid]}


KERNEL = """
import os
from numba import njit
@njit(cache=True)
def double(x): return 2 * x
def learn(): double(21)
def leisure_steps(): return (learn,)
def tell(payload, channel):
    return {"compiled": len(double.signatures), "kept": [name for name in os.listdir(payload["cache"]) if "double" in name]}
"""


def test_kernels_are_compiled_beside_the_nursery_and_loaded_by_it(
    own_nursery: Callable[..., Nursery], limits: Limits, scratch: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (scratch / "kernels.py").write_text(KERNEL)
    monkeypatch.syspath_prepend(scratch)
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    cache = str(scratch / "__pycache__")
    nursery = own_nursery("kernels")
    told = call(nursery, "kernels:tell", {"cache": cache}, limits, scratch)  # answered while the kernel is compiled elsewhere
    latest = time.monotonic() + 60
    while not told["compiled"] and time.monotonic() < latest:
        time.sleep(0.05)
        told = call(nursery, "kernels:tell", {"cache": cache}, limits, scratch)
    assert told["compiled"] == 1
    assert any(name.endswith(".nbi") for name in told["kept"])


def test_a_spare_child_that_died_costs_nobody_a_job(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    call(nursery, TARGETS + "echo", {}, limits, scratch)
    assert nursery.pid is not None
    for _ in range(3):
        latest = time.monotonic() + 10
        while not (waiting := children_of(nursery.pid)) and time.monotonic() < latest:
            time.sleep(0.01)
        assert len(waiting) == 1
        os.kill(waiting[0], signal.SIGKILL)
        assert wait_for_end(waiting) == []
        assert call(nursery, TARGETS + "echo", {"n": 1}, limits, scratch) == {"n": 1}


def test_no_child_does_a_second_job(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    described = [call(nursery, TARGETS + "describe_surroundings", {}, limits, scratch) for _ in range(4)]
    assert len({one["pid"] for one in described}) == 4
