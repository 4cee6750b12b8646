"""API and worker whose database, broker and object store are away say so, and never with what is in the settings' URLs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from server.address import choose_port
from store.settings import Settings

PASSWORDS = ("open-sesame-database", "open-sesame-broker", "open-sesame/objects")
HOOK = "whsec_" + "c2VzYW1lLW9wZW4tc2VzYW1lLW9wZW4tc2VzYW1l"
LOUD = ('"level": "warning"', '"level": "error"', '"level": "critical"')
LIMIT_S = 90.0


@pytest.mark.parametrize("part", ["api", "worker"])
def test_nothing_of_the_settings_that_is_secret_is_said(part: str, tmp_path: Path) -> None:
    nobody = choose_port("127.0.0.1", 0)
    settings = Settings(
        data_dir=tmp_path,
        database_url=f"postgresql://ada:{PASSWORDS[0]}@127.0.0.1:{nobody}/integument",
        broker_url=f"redis://:{PASSWORDS[1]}@127.0.0.1:{nobody}/0",
        blobs_url=f"s3+http://KEY7:{PASSWORDS[2].replace('/', '%2F')}@127.0.0.1:{nobody}/bucket",
        callback_secret=(HOOK,),
        port=choose_port("127.0.0.1", 0),
        reconcile_s=0.5,
    )
    log = tmp_path / "log"
    with log.open("wb") as file:
        process = subprocess.Popen(
            [sys.executable, "-m", part], env={**os.environ, **settings.as_environment()}, stdout=file, stderr=file, cwd=tmp_path
        )
    try:
        deadline = time.monotonic() + LIMIT_S
        while not any(level in log.read_text() for level in LOUD) and process.poll() is None:
            assert time.monotonic() < deadline, log.read_text()
            time.sleep(0.1)
        time.sleep(1)  # and what it says next
    finally:
        process.kill()
        process.wait()
    said = log.read_text()
    lines = [json.loads(line) for line in said.splitlines()[:-1]]  # the last one may be half
    assert any(line["level"] in ("warning", "error", "critical") for line in lines), said
    assert str(nobody) in said or "unavailable" in said, "it says what is away"
    for secret in (*PASSWORDS, PASSWORDS[2].replace("/", "%2F"), HOOK, HOOK.removeprefix("whsec_")):
        assert secret not in said
