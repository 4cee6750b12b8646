"""No secret gets through, and what is no secret stays readable."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from store.key_text import make_key_text
from store.redaction import Redaction
from store.settings import Settings

WHSEC = "whsec_" + "MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"


@pytest.fixture
def redaction(tmp_path: Path) -> Redaction:
    """Of settings full of secrets."""
    return Redaction.of(
        Settings(
            data_dir=tmp_path,
            database_url="postgresql://ada:open%2Fsesame@db.lab/integument",
            broker_url="rediss://:swordfish@valkey.lab:6379/0",
            blobs_url="s3+https://AKIA123:abc/def+ghi=@s3.lab/bucket".replace("/def", "%2Fdef"),
            callback_secret=(WHSEC,),
        )
    )


@pytest.mark.parametrize(
    ("text", "secrets"),
    [
        ("connection to postgresql://ada:open%2Fsesame@db.lab/x failed", ["open%2Fsesame", "open/sesame"]),
        ('password authentication failed, tried "open/sesame"', ["open/sesame"]),
        ("NOAUTH for rediss://:swordfish@valkey.lab", ["swordfish"]),
        ("SignatureDoesNotMatch abc/def+ghi= and abc%2Fdef%2Bghi%3D", ["abc/def+ghi=", "abc%2Fdef%2Bghi%3D"]),
        (f"signed with {WHSEC}", [WHSEC, WHSEC.removeprefix("whsec_")]),
        (f"decoded {WHSEC.removeprefix('whsec_')}", [WHSEC.removeprefix("whsec_")]),
        ("whsec_another/one+of/somebody==", ["another/one"]),
        ("GET https://s3.lab/b/k?X-Amz-Credential=AKIA%2F2026&X-Amz-Signature=0a1b2c&x=1", ["AKIA%2F2026", "0a1b2c"]),
        ("Authorization: AWS4-HMAC-SHA256 Credential=AKIA123/20261122/x/s3, Signature=0a1b2c3d4e5f6a7b8c9d", ["0a1b2c3d4e5f"]),
        ("Authorization: Bearer abcdefghijklmnop", ["abcdefghijklmnop"]),
        ("http://user:pa%20ss@proxy:3128 refused", ["pa%20ss"]),
    ],
)
def test_secrets_are_taken_out(redaction: Redaction, text: str, secrets: list[str]) -> None:
    for said in (redaction(text), redaction(json.dumps({"message": text}))):
        assert [secret for secret in secrets if secret in said] == []
        assert "***" in said
    assert set(json.loads(redaction(json.dumps({"message": text})))) == {"message"}


def test_a_key_keeps_its_id(redaction: Redaction) -> None:
    key = make_key_text()
    assert redaction(f"GET /v1/jobs/{key.text}") == f"GET /v1/jobs/itg_{key.id}_***"


@pytest.mark.parametrize(
    "text",
    [
        "job 0b9a6d0e-8f3c-4a55-9d51-3f1f6f1d7c20: attempt 1 of shells begins",
        "worker integument@host-a:17 is ready, 2 jobs at a time",
        "Integument answers at http://127.0.0.1:8000 (data in /srv/data)",
        "GET http://s3.lab:8333/bucket/" + "a" * 64,
        "ada at db.lab: 12:30:45 a@b",
    ],
)
def test_everything_else_stays(redaction: Redaction, text: str) -> None:
    assert redaction(text) == text
    assert Redaction()(text) == text
