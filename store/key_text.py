"""The text of an API key: `itg_<id>_<secret>_<checksum>`.

The id is looked up, the secret proves, and the checksum tells a mistyped or cut-off key without asking the database; scanners
for leaked secrets find it by its form."""

from __future__ import annotations

import hashlib
import re
import secrets
import string
import zlib
from dataclasses import dataclass, field

PREFIX = "itg"
ID_CHARACTERS = 12
SECRET_CHARACTERS = 43  # of 62: 256 bits
CHECKSUM_CHARACTERS = 6
_ALPHABET = string.digits + string.ascii_uppercase + string.ascii_lowercase
_KEY = re.compile(
    rf"(?P<body>{PREFIX}_(?P<id>[0-9A-Za-z]{{{ID_CHARACTERS}}})_[0-9A-Za-z]{{{SECRET_CHARACTERS}}})"
    rf"_(?P<checksum>[0-9A-Za-z]{{{CHECKSUM_CHARACTERS}}})"
)
_ANYWHERE = re.compile(
    rf"{PREFIX}_([0-9A-Za-z]{{{ID_CHARACTERS}}})_[0-9A-Za-z]{{1,{SECRET_CHARACTERS}}}(?:_[0-9A-Za-z]{{1,{CHECKSUM_CHARACTERS}}})?"
)


@dataclass(frozen=True, slots=True)
class KeyText:
    """A key in the form its user sends; it does not show in messages."""

    id: str
    text: str = field(repr=False)

    @property
    def digest(self) -> str:
        """SHA-256, what is stored. A secret of 256 random bits needs no slow hash: there is nothing to guess."""
        return hashlib.sha256(self.text.encode("ascii")).hexdigest()


def make_key_text() -> KeyText:
    """A new one."""
    key_id = _random(ID_CHARACTERS)
    body = f"{PREFIX}_{key_id}_{_random(SECRET_CHARACTERS)}"
    return KeyText(key_id, f"{body}_{_checksum(body)}")


def read_key_text(sent: str) -> KeyText | None:
    """None unless it has the form of a key and its checksum."""
    match = _KEY.fullmatch(sent)
    if match is None or _checksum(match["body"]) != match["checksum"]:
        return None
    return KeyText(match["id"], sent)


def without_secrets(text: str) -> str:
    """The text with the secret of every key in it taken out; ids stay."""
    return _ANYWHERE.sub(rf"{PREFIX}_\1_***", text)


def _random(characters: int) -> str:
    return "".join(secrets.choice(_ALPHABET) for _ in range(characters))


def _checksum(body: str) -> str:
    number, digits = zlib.crc32(body.encode("ascii")), ""
    for _ in range(CHECKSUM_CHARACTERS):
        number, digit = divmod(number, len(_ALPHABET))
        digits = _ALPHABET[digit] + digits
    return digits
