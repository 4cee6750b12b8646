"""Whatever a child says becomes something both databases take."""

from __future__ import annotations

import json
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from store.storable import MAX_DEPTH, storable, storable_text

TEXT = st.text(st.characters(codec=None, exclude_categories=()), max_size=50)
JSON_LIKE = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | TEXT,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXT, inner, max_size=4),
    max_leaves=20,
)


@given(JSON_LIKE)
def test_it_can_always_be_written(value: Any) -> None:
    made = storable(value)
    text = json.dumps(made, allow_nan=False, ensure_ascii=False)
    text.encode("utf-8")
    assert "\\u0000" not in text
    assert storable(made) == made


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text("abc é"),
        lambda inner: st.lists(inner) | st.dictionaries(st.text("abc"), inner),
        max_leaves=10,
    )
)
def test_what_is_harmless_stays_as_it_is(value: Any) -> None:
    assert storable(value) == value


def test_long_text_is_cut_and_says_so() -> None:
    assert storable_text("x" * 100, limit=10) == "x" * 9 + "…"
    assert storable_text("x" * 10, limit=10) == "x" * 10


def test_depth_has_an_end() -> None:
    deep: Any = "bottom"
    for _ in range(900):
        deep = {"k": [deep]}
    made = storable(deep)
    for _ in range(MAX_DEPTH // 2):
        made = made["k"][0]
    assert made == "…"
