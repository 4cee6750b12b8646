"""What clients are told of their rate."""

from __future__ import annotations

import pytest

from api.access import Access
from api.rate import rate_headers, require_allowance
from core.errors import LimitError
from store.rate_limit import Allowance
from store.scope import Scope
from store.workspace import WorkspaceId

ACCESS = Access(WorkspaceId("lab"), frozenset(Scope), None)


@pytest.mark.parametrize(("tokens", "told"), [(4.0, "r=4;t=2"), (3.999, "r=3;t=3"), (0.25, "r=0;t=10"), (0.0, "r=0;t=10")])
def test_headers_tell_whole_requests_and_seconds(tokens: float, told: str) -> None:
    assert rate_headers(Allowance(True, 5, 0.5, tokens)) == {
        "RateLimit-Policy": '"workspace";q=5;w=10',
        "RateLimit": f'"workspace";{told}',
    }


@pytest.mark.parametrize(("tokens", "wait_s"), [(0.0, 2), (0.4, 2), (0.5, 1), (0.999, 1)])
def test_a_refusal_says_when_to_come_again(tokens: float, wait_s: int) -> None:
    with pytest.raises(LimitError) as caught:
        require_allowance(ACCESS, Allowance(False, 5, 0.5, tokens))
    assert caught.value.code == "rate.exceeded"
    assert caught.value.facts["retry_after_s"] == wait_s


def test_whoever_is_not_counted_passes() -> None:
    require_allowance(ACCESS, None)
    require_allowance(ACCESS, Allowance(True, 5, 0.5, 0.0))
