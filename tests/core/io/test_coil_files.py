from __future__ import annotations

import base64
import json
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.coil import Coil
from core.errors import InputError, InternalError, LimitError
from core.io import tcd
from core.io.canonical_coil import load_coil, save_coil
from core.io.ccd import read_ccd
from core.io.tcd import read_tcd
from subjects.figure_eight import figure_eight, write_ccd


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "coil"


def packed(rows: np.ndarray) -> str:
    return base64.b64encode(zlib.compress(rows.tobytes())).decode()


def write_tcd(path: Path, *elements: Any) -> None:
    path.write_text(json.dumps({"name": "test", "coilElementList": list(elements), "stimulatorList": [{"name": "any"}]}))


def test_metres_become_millimetres(file: Path) -> None:
    coil = figure_eight()
    write_ccd(coil, file)
    found, findings = read_ccd(file)
    assert findings == ()
    np.testing.assert_allclose(found.positions, coil.positions, atol=1e-6)
    np.testing.assert_allclose(found.moments, coil.moments, rtol=1e-9)


def test_a_count_that_is_missing_is_told(file: Path) -> None:
    file.write_text("# places\n0 0 0 0 0 1\n0.05 0 0 0 0 -1\n")
    coil, findings = read_ccd(file)
    assert len(coil.positions) == 2
    assert [each.code for each in findings] == ["coil.count_missing"]


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("3\n0 0 0 0 0 1\n0.05 0 0 0 0 -1\n", "coil.count_mismatch", "announces 3 dipoles and has 2"),
        ("2\n0 0 0 1\n0.05 0 0 -1\n", "coil.columns", "4 columns"),
        ("2\n0 0 0 0 0 1\n50 0 0 0 0 1\n", "coil.size", "50 mm wide"),  # mm where metres are wanted
        ("2\n0 0 0 0 0 1\nnan 0 0 0 0 1\n", "coil.not_finite", "1 rows"),
        ("2\n", "table.empty", "no numbers"),
    ],
)
def test_dipoles_that_are_wrong_are_named(file: Path, text: str, code: str, words: str) -> None:
    file.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        read_ccd(file)
    assert caught.value.code == code


def test_lists_and_packed_arrays_are_the_same(file: Path) -> None:
    coil = figure_eight()
    write_tcd(file, {"type": 1, "points": coil.positions.tolist(), "values": coil.moments.tolist()})
    plain, _ = read_tcd(file)
    write_tcd(file, {"type": 1, "points": packed(coil.positions), "values": packed(coil.moments)})
    unpacked, _ = read_tcd(file)
    np.testing.assert_array_equal(plain.positions, coil.positions)
    np.testing.assert_array_equal(unpacked.positions, coil.positions)
    np.testing.assert_array_equal(unpacked.moments, coil.moments)


def test_wire_without_values_closes(file: Path) -> None:
    write_tcd(file, {"type": 2, "points": [[0, 0, 0], [40, 0, 0], [0, 30, 0]]})
    coil, _ = read_tcd(file)
    np.testing.assert_array_equal(coil.wire_along, [[40, 0, 0], [-40, 30, 0], [0, -30, 0]])
    np.testing.assert_array_equal(coil.wire, [[20, 0, 0], [20, 15, 0], [0, 15, 0]])


def test_sampled_potentials_are_left_out_and_never_unpickled(file: Path) -> None:
    write_tcd(file, {"type": 3, "data": "gASVAAAA"}, {"type": 1, "points": [[0, 0, 0]], "values": [[0, 0, 1]]})
    coil, findings = read_tcd(file)
    assert len(coil.positions) == 1
    assert [each.code for each in findings] == ["coil.element_left_out"]


@pytest.mark.parametrize(
    "text",
    [
        "[" * 100_000,
        "{}",
        "[]",
        "not json",
        '{"coilElementList": 3}',
        '{"coilElementList": [3]}',
        '{"coilElementList": [{"type": 9}]}',
        '{"coilElementList": [{"type": [1]}]}',
        '{"coilElementList": [{"type": 1, "points": [[1, 2]], "values": [[1, 2]]}]}',
        '{"coilElementList": [{"type": 1, "points": [[1, 2, "x"]], "values": [[1, 2, 3]]}]}',
        '{"coilElementList": [{"type": 1, "points": "AAAA", "values": "!"}]}',
        '{"coilElementList": [{"type": 1, "points": null}]}',
    ],
)
def test_what_is_no_coil_is_corrupt(file: Path, text: str) -> None:
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        read_tcd(file)
    assert caught.value.code == "coil.corrupt"


def test_deflated_bombs_are_not_unpacked(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tcd, "MOST_ROWS", 10)
    rows = np.zeros((11, 3))
    write_tcd(file, {"type": 1, "points": packed(rows), "values": packed(rows)})
    with pytest.raises(LimitError) as caught:
        read_tcd(file)
    assert caught.value.code == "coil.too_large"
    monkeypatch.setattr(tcd, "MOST_BYTES", 10)
    with pytest.raises(LimitError, match="10 are read"):
        read_tcd(file)


def test_points_and_values_that_differ_in_number(file: Path) -> None:
    write_tcd(file, {"type": 1, "points": [[0, 0, 0]], "values": [[0, 0, 1]] * 2})
    with pytest.raises(InputError) as caught:
        read_tcd(file)
    assert caught.value.code == "coil.count_mismatch"


def test_no_dipoles_and_no_wire() -> None:
    with pytest.raises(InputError) as caught:
        Coil.of([], [])
    assert caught.value.code == "coil.no_dipoles"


def test_the_canonical_form_holds_it_all(file: Path) -> None:
    coil = Coil.of([[0.0, 0, 0]], [[0.0, 0, 1]], [[50.0, 0, 0]], [[1.0, 2, 3]])
    save_coil(coil, file)
    found = load_coil(file)
    for name in ("positions", "moments", "wire", "wire_along"):
        np.testing.assert_array_equal(getattr(found, name), getattr(coil, name))
    file.write_bytes(file.read_bytes()[:-1])
    with pytest.raises(InternalError, match="checksum"):
        load_coil(file)


def test_a_placement_moves_places_and_turns_moments() -> None:
    placement = np.array([[0.0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 30], [0, 0, 0, 1]])
    coil = Coil.of([[5.0, 0, 0], [-5, 0, 0]], [[1.0, 0, 0], [0, 0, 2]]).placed(placement)
    np.testing.assert_allclose(coil.positions, [[10, 25, 30], [10, 15, 30]])
    np.testing.assert_allclose(coil.moments, [[0, 1, 0], [0, 0, 2]], atol=1e-15)
