"""`integument admin`: keys, workspaces and the audit log, on the database the settings name."""

from __future__ import annotations

import json
import signal
import stat
import subprocess
import sys
from pathlib import Path

import httpx
import pytest
from integument.cli import main

from server.admin.command import admin
from store.callback_secret import workspace_secret
from store.workspace import WorkspaceId
from tests.embedded import embedded
from tests.postgres import PostgresServer
from tests.server.conftest import Run

pytestmark = pytest.mark.usefixtures("bare_environment")


@pytest.fixture(params=["sqlite", "postgresql"])
def _database(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.param == "postgresql":
        server: PostgresServer = request.getfixturevalue("postgres")
        monkeypatch.setenv("INTEGUMENT_DATABASE_URL", server.new_database())


def test_a_workspace_has_a_callback_secret_of_its_own(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    run("workspaces", "create", "lab-a")
    assert admin(["workspaces", "callback-secret", "lab-a"]) == 2, "without one of the server there is none"
    secret = "whsec_" + "c2VzYW1l" * 4
    monkeypatch.setenv("INTEGUMENT_CALLBACK_SECRET", secret)
    shown = run("workspaces", "callback-secret", "lab-a")
    assert shown == {"workspace": "lab-a", "secrets": [workspace_secret(secret, WorkspaceId("lab-a"))]}
    assert run("workspaces", "callback-secret", "default")["secrets"] == [secret]


@pytest.mark.usefixtures("_database")
def test_the_life_of_a_key(run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    run("workspaces", "create", "lab-a", "--quota-bytes", "5GiB", "--quota-jobs", "20")
    made = run("keys", "create", "--workspace", "lab-a", "--name", "robot", "--scope", "read", "--scope", "admin", "--days", "90")
    assert made["key"].startswith(f"itg_{made['id']}_")
    assert (made["workspace"], made["scopes"], made["state"]) == ("lab-a", ["admin", "read"], "live")
    usual = run("keys", "create")
    assert (usual["workspace"], usual["scopes"], usual["expires"]) == ("default", ["read", "submit"], None)

    successor = run("keys", "rotate", made["id"], "--overlap-days", "1")
    assert run("keys", "revoke", usual["id"])["state"] == "revoked"
    listed = {key["id"]: key for key in run("keys", "list")}
    assert {key["state"] for key in listed.values()} == {"live", "revoked"}
    assert listed[made["id"]]["replaced_by"] == successor["id"]
    assert [key["id"] for key in run("keys", "list", "--workspace", "default")] == [usual["id"]]
    assert all("key" not in key for key in listed.values())

    (default, lab) = run("workspaces", "list")
    assert (lab["id"], lab["quota_bytes"], lab["quota_jobs"], lab["bytes"], lab["jobs"]) == ("lab-a", 5 * 1024**3, 20, 0, 0)
    assert (default["id"], default["quota_bytes"]) == ("default", None)

    assert admin(["--json", "audit"]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(line["action"], line["workspace"], line["outcome"]) for line in reversed(lines)] == [
        ("workspaces create", "lab-a", "done"),
        ("keys create", "lab-a", "done"),
        ("keys create", "default", "done"),
        ("keys rotate", "lab-a", "done"),
        ("keys revoke", "default", "done"),
    ]
    assert all(line["actor"].startswith("admin") for line in lines)
    assert made["key"].split("_")[2] not in json.dumps(lines)


def test_people_get_text_and_the_key_alone_goes_to_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    assert admin(["keys", "create", "--name", "me"]) == 0
    told = capsys.readouterr()
    key = told.out.split("\n")[0].split()[1]
    assert key.startswith("itg_")
    assert "this once" in told.err
    assert "every request needs a key" in told.err
    assert admin(["keys", "list"]) == 0
    listed = capsys.readouterr().out
    assert "read,submit" in listed
    assert key not in listed
    assert admin(["audit"]) == 0
    assert "keys create" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("keys create --workspace nowhere", "workspace.not_found"),
        ("workspaces create Lab", "workspace.id_invalid"),
        ("workspaces create default", "workspace.exists"),
        ("keys revoke nobody", "key.not_found"),
        ("keys rotate nobody", "key.not_found"),
        ("keys create --scope all", "invalid choice"),
        ("keys create --days 0", "--days"),
        ("keys create --days soon", "--days"),
        ("workspaces create a --quota-bytes much", "--quota-bytes"),
        ("workspaces create a --quota-jobs -1", "--quota-jobs"),
        ("", "required"),
        ("keys", "required"),
    ],
)
def test_what_cannot_be_done_is_said(words: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert admin(words.split()) == 2
    assert said in capsys.readouterr().err


def test_settings_and_databases_at_fault_are_said(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("INTEGUMENT_DATABASE_URL", "postgresql://sesame:sesame@127.0.0.1:1/nothing")
    assert admin(["keys", "list"]) == 1
    assert "database.unavailable" in (told := capsys.readouterr().err)
    assert "sesame" not in told
    monkeypatch.setenv("INTEGUMENT_LEASE", "3")
    assert admin(["keys", "list"]) == 2
    assert "INTEGUMENT_LEASE_S" in capsys.readouterr().err


def test_the_command_line_hands_it_on(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["admin", "keys", "create", "--name", "x", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "x"
    assert main(["admin", "--help"]) == 0
    assert "workspaces" in capsys.readouterr().out
    assert main(["admin", "keys", "rotate"]) == 2


def test_nobody_else_can_read_what_it_makes(tmp_path: Path) -> None:
    assert admin(["workspaces", "list"]) == 0
    assert stat.S_IMODE((tmp_path / "data").stat().st_mode) == 0o700


def test_a_server_beyond_loopback_needs_a_key_and_asks_for_it(tmp_path: Path, run: Run) -> None:
    command = [sys.executable, "-m", "server", "--host", "0.0.0.0", "--port", "0", "--data-dir", str(tmp_path / "data")]
    refused = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert refused.returncode == 2
    assert "server.host_not_loopback" in refused.stderr
    assert not (tmp_path / "data").exists()
    key = run("keys", "create", "--scope", "read")["key"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        said = process.stderr.readline()
        url = said.split(" at ")[1].split()[0]
        assert httpx.get(f"{url}/v1/jobs", trust_env=False).status_code == 401
        assert httpx.get(f"{url}/v1/jobs", headers={"Authorization": f"Bearer {key}"}, trust_env=False).status_code == 200
    finally:
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)


def test_a_key_made_while_the_embedded_server_runs_closes_it(tmp_path: Path, run: Run) -> None:
    with embedded(tmp_path / "data") as server:
        assert httpx.get(f"{server.url}/v1/jobs", trust_env=False).status_code == 200
        key = run("keys", "create")["key"]
        assert httpx.get(f"{server.url}/v1/jobs", trust_env=False).status_code == 401
        headers = {"Authorization": f"Bearer {key}"}
        assert httpx.get(f"{server.url}/v1/jobs", headers=headers, trust_env=False).status_code == 200
        assert main(["jobs", "--server", server.url, "--json"]) == 2
