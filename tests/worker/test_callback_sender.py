"""One delivery to a real receiver: signature, answers, and addresses it must not reach."""

from __future__ import annotations

import ssl
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from ipaddress import ip_address
from pathlib import Path

import pytest
import trustme
from standardwebhooks.webhooks import Webhook, WebhookVerificationError

from store.callback import Callback, CallbackEvent, CallbackState
from store.callback_secret import secret_bytes, workspace_secret
from store.forbidden_addresses import Address
from store.receivers import Receivers
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from tests.worker.receiver import Receiver, receiving
from worker.callback_sender import CallbackSender
from worker.signature import signature_headers

SECRET = "whsec_" + "c2VzYW1l" * 4
OLD_SECRET = "whsec_" + "b3BlbiAh" * 4
LOOPBACK = ("127.0.0.1",)
REFUSAL = "not on the public internet"


def message(uri: str, body: str = '{"jobID": "1", "message": "Größe"}') -> Callback:
    now = datetime.now(UTC)
    state = CallbackState.PENDING
    return Callback("msg-1", DEFAULT_WORKSPACE, "job", CallbackEvent.SUCCESS, uri, body, state, 1, 1, now, now, None, None, None)


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as receiver:
        yield receiver


def test_receivers_of_one_workspace_cannot_forge_for_another(receiver: Receiver) -> None:
    theirs = replace(message(receiver.url), workspace=WorkspaceId("lab-a"))
    assert CallbackSender(Receivers(LOOPBACK), [SECRET, OLD_SECRET]).send(theirs).is_success
    (received,) = receiver.received
    for secret in (SECRET, OLD_SECRET):  # also while one secret replaces another
        derived = workspace_secret(secret, WorkspaceId("lab-a"))
        assert secret_bytes(derived) != secret_bytes(secret)
        assert Webhook(derived).verify(received.body, received.headers)["jobID"] == "1"
        for other in (secret, workspace_secret(secret, WorkspaceId("lab-b"))):
            with pytest.raises(WebhookVerificationError):
                Webhook(other).verify(received.body, received.headers)


def sender(*allowed: str, **more: object) -> CallbackSender:
    return CallbackSender(Receivers(allowed), [SECRET], **more)  # type: ignore[arg-type]


def test_the_receiver_can_verify_it(receiver: Receiver) -> None:
    answer = CallbackSender(Receivers(LOOPBACK), [SECRET, OLD_SECRET]).send(message(receiver.url))
    assert (answer.status, answer.is_success) == (204, True)
    (received,) = receiver.received
    assert (received.method, received.path) == ("POST", "/hook?job=1")
    assert received.headers["host"] == f"127.0.0.1:{receiver.port}"
    assert received.headers["content-type"] == "application/json"
    assert received.headers["webhook-id"] == "msg-1"
    for secret in (SECRET, OLD_SECRET):
        assert Webhook(secret).verify(received.body, received.headers) == {"jobID": "1", "message": "Größe"}
    with pytest.raises(WebhookVerificationError):
        Webhook("whsec_" + "YW5vdGhl" * 4).verify(received.body, received.headers)
    with pytest.raises(WebhookVerificationError):
        Webhook(workspace_secret(SECRET, WorkspaceId("lab-a"))).verify(received.body, received.headers)
    with pytest.raises(WebhookVerificationError):
        Webhook(SECRET).verify(received.body + b" ", received.headers)
    stale = received.headers | signature_headers([SECRET], "msg-1", int(time.time()) - 600, received.body)
    with pytest.raises(WebhookVerificationError):
        Webhook(SECRET).verify(received.body, stale)


def test_the_signature_is_that_of_the_standard() -> None:
    """The example of the specification's reference libraries."""
    made = signature_headers(
        ["whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"],
        "msg_p5jXN8AQM9LWM0D4loKWxJek",
        1614265330,
        b'{"test": 2432232314}',
    )
    assert made["webhook-signature"] == "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE="


@pytest.mark.parametrize(
    ("status", "success", "final"),
    [
        *((status, True, False) for status in (200, 202, 204, 299)),
        *((status, False, False) for status in (300, 304, 400, 404, 409, 500, 503)),
        (410, False, True),
    ],
)
def test_2xx_alone_is_success_and_410_the_end(receiver: Receiver, status: int, success: bool, final: bool) -> None:
    receiver.answers = [status]
    answer = sender(*LOOPBACK).send(message(receiver.url))
    assert (answer.status, answer.is_success, answer.is_final) == (status, success, final)


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_redirects_are_not_followed(receiver: Receiver, status: int) -> None:
    with receiving() as other:
        receiver.answers = [(status, other.url)]
        answer = sender(*LOOPBACK).send(message(receiver.url))
        assert (answer.status, answer.is_success, other.received) == (status, False, [])


def test_proxies_of_the_environment_are_not_used(receiver: Receiver, monkeypatch: pytest.MonkeyPatch) -> None:
    with receiving() as proxy:
        for name in ("http_proxy", "https_proxy", "all_proxy", "HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY"):
            monkeypatch.setenv(name, f"http://127.0.0.1:{proxy.port}")
        monkeypatch.delenv("no_proxy", raising=False)
        assert sender(*LOOPBACK).send(message(receiver.url)).is_success
        assert (len(receiver.received), proxy.received) == (1, [])


def test_nobody_there_silence_and_drips_are_failures(receiver: Receiver) -> None:
    with receiving() as gone:
        pass
    assert "ConnectError" in sender(*LOOPBACK).send(message(gone.url)).error
    assert "looked up" in sender("nowhere.invalid").send(message("http://nowhere.invalid/")).error
    for how in ("silent", "dripping"):
        receiver.drip = how == "dripping"
        if how == "silent":
            receiver.holding.set()
        started = time.monotonic()
        answer = sender(*LOOPBACK, timeout_s=0.5).send(message(receiver.url))
        assert (answer.status, answer.error) == (None, "no answer within 0.5 s")
        assert time.monotonic() - started < 3
        receiver.holding.clear()


FORBIDDEN = [
    "0.0.0.0", "0.1.2.3", "10.0.0.1", "100.64.0.1", "127.0.0.1", "127.8.8.8", "169.254.169.254", "172.16.0.1", "172.31.255.255",
    "192.0.0.8", "192.0.2.1", "192.168.1.1", "198.18.0.1", "198.51.100.1", "203.0.113.1", "224.0.0.1", "239.1.1.1", "240.0.0.1",
    "255.255.255.255", "::", "::1", "::127.0.0.1", "::ffff:127.0.0.1", "::ffff:10.0.0.1", "::ffff:a9fe:a9fe",
    "::ffff:0:7f00:1", "64:ff9b::a9fe:a9fe", "64:ff9b::7f00:1", "64:ff9b:1::1", "100::1", "2001::1", "2001:db8::1",
    "2002:7f00:1::", "2002:a9fe:a9fe::1", "2002:c0a8:101::5", "3fff::1", "5f00::1", "fc00::1", "fd12:3456::1", "fe80::1",
    "fec0::1", "ff02::1",
]  # fmt: skip
PUBLIC = [
    "1.1.1.1", "93.184.216.34", "172.32.0.1", "100.128.0.1", "2606:4700::1111", "::ffff:1.1.1.1", "64:ff9b::101:101",
    "2002:101:101::1",
]  # fmt: skip


@pytest.mark.parametrize("text", FORBIDDEN)
def test_no_private_address_is_reached_by_name_or_number(text: str) -> None:
    address = ip_address(text)

    def resolve(host: str, port: int) -> Sequence[Address]:
        return [ip_address("93.184.216.34"), address]  # one bad address among good ones spoils the name

    answer = sender(resolve=resolve).send(message("https://lab.example/"))
    assert (answer.status, REFUSAL in answer.error, text in answer.error) == (None, True, False)
    literal = f"[{text}]" if ":" in text else text
    assert REFUSAL in sender().send(message(f"https://{literal}/")).error
    for allowed in ([text], ["0.0.0.0/0", "::/0"]):
        Receivers(allowed).require_address("lab.example", address)
        Receivers(allowed).require_uri(f"http://{literal}:8080/")


@pytest.mark.parametrize("text", PUBLIC)
def test_public_addresses_are_not_refused(text: str) -> None:
    Receivers(()).require_address("lab.example", ip_address(text))


def test_a_name_that_leads_home_is_refused_by_the_real_resolver(receiver: Receiver) -> None:
    uri = f"http://localhost:{receiver.port}/"
    assert sender().send(message(uri)).status is None
    assert sender("10.0.0.0/8").send(message(uri)).status is None
    assert receiver.received == []
    assert sender("localhost").send(message(uri)).is_success


def test_a_name_that_changes_its_address_gets_nowhere(receiver: Receiver) -> None:
    """DNS rebinding: the first answer is allowed, the next is not. It is asked once per delivery, and that one is checked."""
    with receiving("127.0.0.2", receiver.port) as inner:
        asked: list[str] = []

        def resolve(host: str, port: int) -> Sequence[Address]:
            asked.append(host)
            return [ip_address("127.0.0.1" if len(asked) == 1 else "127.0.0.2")]

        class NameInList(Receivers):
            """Takes the name's scheme and port, but not its address: as for a public name."""

            def require_uri(self, uri: str) -> None:
                """Whatever it is."""

        rebinding = CallbackSender(NameInList(LOOPBACK), [SECRET], resolve=resolve)
        uri = f"http://lab.example:{receiver.port}/"
        assert rebinding.send(message(uri)).is_success
        assert asked == ["lab.example"]
        assert REFUSAL in rebinding.send(message(uri)).error
        assert (len(receiver.received), inner.received) == (1, [])
        assert receiver.received[0].headers["host"] == f"lab.example:{receiver.port}"


def test_the_next_address_is_tried(receiver: Receiver) -> None:
    def resolve(host: str, port: int) -> Sequence[Address]:
        return [ip_address("127.0.0.3"), ip_address("127.0.0.1")]

    assert sender("lab.example", resolve=resolve).send(message(f"http://lab.example:{receiver.port}/")).is_success


def test_tls_is_spoken_to_the_name_not_to_the_address(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    authority = trustme.CA()
    names: list[str | None] = []
    tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    authority.issue_cert("lab.example").configure_cert(tls)
    tls.sni_callback = lambda _socket, name, _context: names.append(name)

    def resolve(host: str, port: int) -> Sequence[Address]:
        return [ip_address("127.0.0.1")]

    with receiving(tls=tls) as receiver:
        uri = f"https://lab.example:{receiver.port}/hook"
        untrusted = sender("lab.example", "other.example", resolve=resolve)
        assert "CERTIFICATE_VERIFY_FAILED" in untrusted.send(message(uri)).error
        authority.cert_pem.write_to_path(str(tmp_path / "ca.pem"))
        monkeypatch.setenv("SSL_CERT_FILE", str(tmp_path / "ca.pem"))
        trusted = sender("lab.example", "other.example", resolve=resolve)
        assert trusted.send(message(uri)).is_success
        assert names == ["lab.example", "lab.example"]
        assert "CERTIFICATE_VERIFY_FAILED" in trusted.send(message(uri.replace("lab.", "other."))).error
        assert len(receiver.received) == 1
