"""Settings: what is accepted, what is refused, what is kept quiet, and that docs/settings.md has them all."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
from pydantic import ByteSize, ValidationError

from store.settings import PREFIX, Settings

DOCS = Path(__file__).resolve().parents[2] / "docs" / "settings.md"


@pytest.fixture(autouse=True)
def _bare_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in os.environ if name.startswith(PREFIX)]:
        monkeypatch.delenv(name)


def read(monkeypatch: pytest.MonkeyPatch, **variables: str) -> Settings:
    for name, value in variables.items():
        monkeypatch.setenv(PREFIX + name.upper(), value)
    return Settings()


def refusal(monkeypatch: pytest.MonkeyPatch, **variables: str) -> str:
    with pytest.raises(ValidationError) as caught:
        read(monkeypatch, **variables)
    return str(caught.value)


def test_the_defaults_are_an_embedded_server_on_loopback(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", "/somewhere")
    settings = Settings()
    assert settings.data_dir == Path("/somewhere/integument")
    assert settings.database_url == "sqlite:////somewhere/integument/integument.sqlite3"
    assert (settings.host, settings.require_keys) == ("127.0.0.1", "auto")
    assert settings.upload_limit_bytes == 2 * 1024**3
    assert settings.blob_dir.parent == settings.scratch_dir.parent == settings.data_dir
    monkeypatch.delenv("XDG_DATA_HOME")
    monkeypatch.setenv("HOME", "/home/somebody")
    assert Settings().data_dir == Path("/home/somebody/.local/share/integument")


def test_variables_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = read(
        monkeypatch,
        data_dir="somewhere",
        database_url="postgresql://u:p@db/integument",
        broker_url="redis+socket:///run/v.sock",
        upload_limit_bytes="3GiB",
        job_memory_bytes="500MB",
        lease_s="60",
        require_keys="true",
        allowed_hosts=" a.example ,B.example,",
    )
    assert settings.data_dir == Path.cwd() / "somewhere"
    assert settings.database_url == "postgresql://u:p@db/integument"
    assert settings.broker_url == "redis+socket:///run/v.sock"
    assert (settings.upload_limit_bytes, settings.job_memory_bytes) == (3 * 1024**3, 500_000_000)
    assert (settings.lease_s, settings.require_keys) == (60.0, "true")
    assert settings.allowed_hosts == ("a.example", "b.example")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("upload_limit_bytes", "0"),
        ("upload_limit_bytes", "-1"),
        ("job_memory_bytes", "much"),
        ("lease_s", "0"),
        ("lease_s", "nan"),
        ("lease_s", "inf"),
        ("heartbeat_s", "-2"),
        ("heartbeat_s", "20"),  # the lease is 30
        ("port", "65536"),
        ("max_attempts", "0"),
        ("worker_concurrency", "0"),
        ("queue", "jobs; drop"),
        ("host", ""),
        ("require_keys", "false"),
        ("database_url", "mysql://u@h/d"),
        ("database_url", "/var/lib/x.sqlite3"),
        ("database_url", "sqlite://"),
        ("database_url", "sqlite:///:memory:"),
        ("database_url", "postgresql+asyncpg://u@h/d"),
        ("broker_url", "amqp://h"),
        ("broker_url", "redis://"),
        ("broker_url", ""),
        ("callback_secret", "sesame"),
        ("callback_secret", "whsec_c2hvcnQ="),
        ("callback_allow", "10.0.0.1/8"),
        ("callback_allow", "http://lab.example"),
    ],
)
def test_nonsense_is_refused(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    assert name in refusal(monkeypatch, **{name: value})


def test_a_misspelt_variable_is_refused_and_the_right_one_named(monkeypatch: pytest.MonkeyPatch) -> None:
    message = refusal(monkeypatch, upload_limit="1GiB")
    assert "INTEGUMENT_UPLOAD_LIMIT" in message
    assert "did you mean INTEGUMENT_UPLOAD_LIMIT_BYTES?" in message


def test_the_clients_variable_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    read(monkeypatch, url="http://127.0.0.1:8000", api_key="itg_of_a_client")


def test_unknown_keywords_are_refused() -> None:
    with pytest.raises(ValidationError):
        Settings.model_validate({"upload_limit": "1GiB"})


def test_settings_do_not_change() -> None:
    name = "port"
    with pytest.raises(ValidationError):
        setattr(Settings(), name, 1)


def test_passwords_are_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = read(monkeypatch, database_url="postgresql://u:sesame@db/d", broker_url="rediss://:sesame@h/0")
    assert "sesame" not in repr(settings) + str(settings)
    assert "sesame" not in refusal(monkeypatch, database_url="mysql://u:sesame@db/d", broker_url="amqp://u:sesame@h")


def test_another_process_reads_the_same(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    settings = Settings(
        data_dir=tmp_path, port=0, require_keys="true", allowed_hosts=("a", "b"), job_cpu_s=0.1, job_file_bytes=ByteSize(7)
    )
    for name, value in settings.as_environment().items():
        monkeypatch.setenv(name, value)
    assert Settings() == settings


def default_of(name: str) -> str:
    """As the docs write it."""
    told: dict[str, Any] = {
        "data_dir": "`$XDG_DATA_HOME/integument`, else `~/.local/share/integument`",
        "database_url": "`sqlite:///{data_dir}/integument.sqlite3`",
        "worker_concurrency": "number of cores",
        "worker_queues": "`fast,heavy`",
        "worker_memory_bytes": "80 % of the machine's, or of the container's limit",
        "allowed_hosts": "none",
        "blobs_url": "none",
        "callback_secret": "none",
        "callback_allow": "none",
    }
    if name in told:
        return str(told[name])
    default = Settings.model_fields[name].default
    if isinstance(default, ByteSize):
        return f"`{default.human_readable().replace('.0', '')}`"
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    return f"`{default:g}`" if isinstance(default, float) else f"`{default}`"


def test_the_docs_have_every_setting() -> None:
    rows = [line for line in DOCS.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    expected = [
        f"| `{PREFIX}{name.upper()}` | {default_of(name)} | {field.description} |"
        for name, field in Settings.model_fields.items()
    ]
    assert rows == expected
