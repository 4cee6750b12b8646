from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.messages import MAX_LINE_BYTES, BrokenMessageError, LineReader, encode


@given(
    messages=st.lists(
        st.dictionaries(st.text(max_size=5), st.none() | st.integers() | st.text(max_size=20), max_size=3), max_size=5
    ),
    cut=st.integers(1, 9),
)
def test_messages_survive_any_cutting(messages: list[dict[str, object]], cut: int) -> None:
    stream = b"".join(map(encode, messages))
    reader = LineReader()
    told = [message for start in range(0, len(stream), cut) for message in reader.feed(stream[start : start + cut])]
    assert told == messages


@pytest.mark.parametrize("line", [b"{\n", b"3\n", b"\xff\n", b"\n", b"[" * 200_000 + b"\n"])
def test_what_is_no_json_object_is_refused(line: bytes) -> None:
    with pytest.raises(BrokenMessageError):
        LineReader().feed(line)


def test_a_line_without_end_is_refused_before_it_fills_memory() -> None:
    reader = LineReader()
    piece = b"x" * (MAX_LINE_BYTES // 8)
    assert [reader.feed(piece) for _ in range(8)] == [[]] * 8
    with pytest.raises(BrokenMessageError):
        reader.feed(piece)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), {1, 2}])
def test_what_json_cannot_say_is_not_sent(value: object) -> None:
    with pytest.raises((ValueError, TypeError)):
        encode({"value": value})
