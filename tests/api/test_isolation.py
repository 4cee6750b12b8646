"""The table of docs/isolation.md is what the server does."""

from __future__ import annotations

from pathlib import Path

from tests.api.access_lab import open_lab
from tests.api.isolation_matrix import PAGE, page_of, settings_in


def test_the_table_is_true_and_nobody_sees_what_is_foreign(tmp_path: Path) -> None:
    with open_lab(settings_in(tmp_path)) as lab:
        lab.ask("GET", "/v1", "stranger")  # that its key was used is noted once, now
        measured = page_of(lab)
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in measured.splitlines() if line.startswith("| `")]
    assert len(rows) >= 30
    for route, need, no_key, read, submit, admin, foreign, absent, alike in rows:
        assert (no_key == "401") == (need != "nothing"), route
        assert {"read": read, "submit": submit, "admin": admin}.get(need) not in ("401", "403"), route
        if foreign:
            assert (foreign, absent, alike) == ("404", "404", "yes"), route
    assert PAGE.read_text(encoding="utf-8") == measured, "make it again: python -m tests.api.isolation_matrix"
