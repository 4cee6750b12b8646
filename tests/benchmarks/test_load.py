"""The load run, small: every part of it works on a real server, and nothing goes wrong. No time is asserted."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from tests.project.sources import ROOT


def test_a_small_run_ends_without_an_error(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "benchmarks.load", "--small", "--out", str(tmp_path)]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=280)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    told = json.loads((tmp_path / "embedded-small.json").read_text())
    assert len(told["parts"]) == 5
    assert all(part["errors"] == [] for part in told["parts"])
    measured = {measure["name"]: measure["value"] for part in told["parts"] for measure in part["measures"]}
    assert measured["6 event streams, told of the end of their job"] == 6
    assert measured["jobs dismissed, one at each stage"] == 1
    assert measured["upload of 8 MiB, memory the API grew by"] < 64
    assert any(part["rss_mib"] for part in told["parts"])
