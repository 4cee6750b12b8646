"""Secrets taken out of what goes to logs: by their form, and the very ones of the settings wherever they turn up."""

from __future__ import annotations

import re
from urllib.parse import quote, unquote, urlsplit

from store.key_text import without_secrets
from store.settings import Settings

HIDDEN = "***"
SHORTEST = 6  # characters; a shorter password is found by its form alone, or every word of a log might be one
_FORMS = (
    (re.compile(r"whsec_[A-Za-z0-9+/=_-]+"), f"whsec_{HIDDEN}"),  # callback secrets
    (re.compile(r"(://[^\s/@:\"'\\]*):[^\s/@\"'\\]+@"), rf"\1:{HIDDEN}@"),  # passwords in URLs
    (re.compile(r"(X-Amz-(?:Signature|Credential|Security-Token)=)[^&\s\"'\\]+", re.IGNORECASE), rf"\1{HIDDEN}"),  # presigned
    (re.compile(r"((?:Signature|Credential)=)[0-9A-Za-z/+=-]{16,}"), rf"\1{HIDDEN}"),  # signed requests to the object store
    (re.compile(r"(Bearer )[A-Za-z0-9._~+/=-]{8,}", re.IGNORECASE), rf"\1{HIDDEN}"),
)


class Redaction:
    """Call it with a text. Ids of keys, user names and hosts stay: they are what a log is read for."""

    def __init__(self, secrets: frozenset[str] = frozenset()) -> None:
        plain = {unquote(secret) for secret in secrets}
        told = {form for form in (*secrets, *plain, *(quote(secret, safe="") for secret in plain)) if len(form) >= SHORTEST}
        self._exact = re.compile("|".join(map(re.escape, sorted(told, key=len, reverse=True)))) if told else None

    @classmethod
    def of(cls, settings: Settings) -> Redaction:
        """Knows the passwords and secrets of these settings."""
        passwords = {
            urlsplit(url).password or "" for url in (settings.database_url, settings.broker_url, settings.blobs_url) if url
        }
        bare = {secret.removeprefix("whsec_") for secret in settings.callback_secret}
        return cls(frozenset(passwords | bare))

    def __call__(self, text: str) -> str:
        """The text without them; JSON stays JSON."""
        if self._exact is not None:
            text = self._exact.sub(HIDDEN, text)
        for form, instead in _FORMS:
            text = form.sub(instead, text)
        return without_secrets(text)
