import itertools

from hypothesis import given
from hypothesis import strategies as st
from integument.event_stream import EventStreamParser, Message

STREAM = (
    b"\xef\xbb\xbf: a comment\r\n"
    b"retry: 1500\r\n\r\n"
    b'id: 1\nevent: progress\ndata: {"a":\ndata: 1}\n\n'
    b"id:2\rdata:x\r\r" + 'id: 3\ndata: "line\u2028separator"\n\n'.encode() + b"event: empty\n\n"
    b"id: 4\nevent: done\ndata: {}\n\n"
    b"id: 5\nevent: log\ndata: never finished"
)
EVENTS = [
    Message("1", "progress", '{"a":\n1}'),
    Message("2", "message", "x"),
    Message("3", "message", '"line\u2028separator"'),
    Message("4", "done", "{}"),
]


@given(st.lists(st.integers(1, len(STREAM) - 1)))
def test_any_cutting_of_the_stream_gives_the_same_events(cuts: list[int]) -> None:
    parser = EventStreamParser()
    edges = [0, *sorted(set(cuts)), len(STREAM)]
    events = [event for start, end in itertools.pairwise(edges) for event in parser.feed(STREAM[start:end])]
    assert events == EVENTS
    assert parser.retry_s == 1.5


def test_the_number_of_an_unfinished_event_does_not_count() -> None:
    parser = EventStreamParser()
    list(parser.feed(b"id: 1\ndata: {}\n\nid: 2\ndata: {"))
    assert parser.last_id == "1"


def test_an_id_with_nul_is_ignored() -> None:
    parser = EventStreamParser("7")
    assert [event.id for event in parser.feed(b"id: a\0b\ndata: x\n\n")] == ["7"]
