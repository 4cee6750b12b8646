"""A step is made once: found again it is the same bits, and what cannot be trusted is made anew."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.mesh import Mesh
from core.processes.checkpoints import checkpoint_file
from core.processes.checkpoints.kept_steps import SUFFIX, KeptSteps
from core.processes.checkpoints.key import key_of
from core.processes.checkpoints.plain import Plain, from_plain, to_plain
from core.processes.software import software_digest
from core.run import RunContext, RunEvent
from core.schema.finding import Finding, Place, Severity
from tests.solids import cube

FINDING = Finding(
    code="mesh.open", severity=Severity.ERROR, message="2 holes", count=2, places=(Place(mesh="a", point_mm=(0.1, -0.0, 3e-300)),)
)
ROOM = 1_000_000


class Attempt:
    """One attempt: what it announced and logged, and how often it computed."""

    def __init__(self, folder: Path, kept: dict[str, Path] | None = None, *, worth_s: float = 0.0, room: int = ROOM) -> None:
        self.folder = folder
        self.folder.mkdir(exist_ok=True)
        self.told: dict[str, str] = {}
        self.events: list[RunEvent] = []
        self.made = 0
        steps = KeptSteps("today", kept or {}, folder, self.told.__setitem__, worth_s=worth_s, room_bytes=room)
        self.run = RunContext(self.events.append, checkpoints=steps)

    def step(self, make: Callable[[], object], *depends: object) -> object:
        def counted() -> object:
            self.made += 1
            return make()

        return self.run.checkpoint("step", counted, *depends)

    def files(self) -> dict[str, Path]:
        return {key: self.folder / f"{key}{SUFFIX}" for key in self.told}


def test_the_second_attempt_takes_what_the_first_made(tmp_path: Path) -> None:
    first = Attempt(tmp_path / "1")
    made = first.step(cube, "edge", 10.0)
    assert list(first.told.values()) == ["step"]
    second = Attempt(tmp_path / "2", first.files())
    found = second.step(cube, "edge", 10.0)
    assert (first.made, second.made, second.told) == (1, 0, {})
    assert [event.message for event in second.events] == ["step: taken from the attempt before"]
    assert isinstance(made, Mesh)
    assert isinstance(found, Mesh)
    assert found.vertices.tobytes() == made.vertices.tobytes() == cube().vertices.tobytes()
    assert not found.vertices.flags.writeable
    assert second.step(cube, "edge", 11.0) is not None
    assert second.made == 1, "another parameter, another step"


def test_a_step_that_fails_keeps_nothing(tmp_path: Path) -> None:
    attempt = Attempt(tmp_path / "1")

    def fail() -> object:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        attempt.step(fail)
    assert attempt.told == {}
    assert list(attempt.folder.iterdir()) == []


@pytest.mark.parametrize("damage", ["cut", "flip", "empty", "gone", "foreign"])
def test_what_is_damaged_is_made_again(tmp_path: Path, damage: str) -> None:
    first = Attempt(tmp_path / "1")
    first.step(cube)
    [path] = first.files().values()
    data = bytearray(path.read_bytes())
    if damage == "gone":
        path.unlink()
    elif damage == "foreign":
        checkpoint_file.write(Plain({"object": ["os:system", {"command": "true"}]}, ()), path)
    else:
        data[len(data) // 2] ^= 1
        path.write_bytes(bytes({"cut": data[:-9], "flip": data, "empty": b""}[damage]))
    second = Attempt(tmp_path / "2", first.files())
    assert isinstance(second.step(cube), Mesh)
    assert (second.made, len(second.told)) == (1, 1)


def test_quick_and_huge_steps_are_not_kept(tmp_path: Path) -> None:
    for attempt in (Attempt(tmp_path / "quick", worth_s=60.0), Attempt(tmp_path / "huge", room=10)):
        assert isinstance(attempt.step(cube), Mesh)
        assert attempt.told == {}
        assert list(attempt.folder.iterdir()) == []


def test_a_full_disk_costs_the_checkpoint_not_the_job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    attempt = Attempt(tmp_path / "1")
    attempt.folder.rmdir()
    assert isinstance(attempt.step(cube), Mesh)
    assert attempt.told == {}


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.lists(inner, max_size=4).map(tuple)
        | st.dictionaries(st.text() | st.integers() | st.tuples(st.text(), st.integers()), inner, max_size=4)
    ),
    max_leaves=20,
)


@given(VALUES)
def test_any_value_comes_back_as_it_was(value: object) -> None:
    again = from_plain(to_plain(value))
    assert again == value
    assert repr(again) == repr(value)  # tells 1 from 1.0 from True, a tuple from a list


def test_what_json_does_not_have_comes_back_too(tmp_path: Path) -> None:
    value: dict[str, Any] = {
        "finding": FINDING,
        "severity": Severity.INFO,
        "numbers": (math.inf, -math.inf, -0.0, np.float64(0.1), np.int32(7)),
        "arrays": [np.arange(6.0).reshape(2, 3).T, np.array([True, False]), np.empty((0, 3), np.int32), np.array([math.nan])],
    }
    checkpoint_file.write(to_plain(value), tmp_path / "value")
    again = from_plain(checkpoint_file.read(tmp_path / "value"))
    assert again["finding"] == FINDING
    assert again["severity"] is Severity.INFO
    assert repr(again["numbers"]) == "(inf, -inf, -0.0, 0.1, 7)"
    for was, now in zip(value["arrays"], again["arrays"], strict=True):
        assert (was.dtype, was.shape) == (now.dtype, now.shape)
        assert now.flags.c_contiguous
        assert now.flags.writeable
        np.testing.assert_array_equal(was, now)


@pytest.mark.parametrize("value", [io.BytesIO(), object(), np.array(["text"]), np.array([object()]), {1}, b"bytes", int])
def test_what_is_no_value_is_refused(value: object) -> None:
    with pytest.raises(TypeError):
        to_plain(value)


def test_the_key_tells_apart_all_that_decides() -> None:
    ones = np.ones((2, 3))
    keys = [
        key_of("today", "step", ()),
        key_of("tomorrow", "step", ()),
        key_of("today", "other", ()),
        key_of("today", "step", (1,)),
        key_of("today", "step", (1.0,)),
        key_of("today", "step", ("1",)),
        key_of("today", "step", ([1],)),
        key_of("today", "step", (ones,)),
        key_of("today", "step", (ones.reshape(3, 2),)),
        key_of("today", "step", (ones.astype(np.float32),)),
        key_of("today", "step", (np.nextafter(ones, 2),)),
    ]
    assert len(set(keys)) == len(keys)
    assert key_of("today", "step", (ones,)) == key_of("today", "step", (np.asfortranarray(ones),))


def test_the_digest_of_the_software_is_stable() -> None:
    first = software_digest()
    software_digest.cache_clear()
    assert software_digest() == first
