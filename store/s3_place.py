"""Where blobs are in an object store, out of one URL."""

from __future__ import annotations

from dataclasses import dataclass, field
from urllib.parse import parse_qs, unquote, urlsplit

SCHEMES = ("s3", "s3+http", "s3+https")


@dataclass(frozen=True, slots=True)
class S3Place:
    """`endpoint` None: that of AWS. `key` and `secret` None: as the environment says (AWS_ACCESS_KEY_ID, profiles, roles)."""

    bucket: str
    prefix: str
    endpoint: str | None
    region: str | None
    key: str | None
    secret: str | None = field(repr=False)

    @classmethod
    def of(cls, url: str) -> S3Place:
        """`s3+https://key:secret@host:port/bucket/folder?region=name`, or `s3://bucket/folder` for AWS.

        Raises ValueError, without the URL: it holds a secret."""
        try:
            parts = urlsplit(url)
            port = parts.port
        except ValueError:
            raise ValueError("blobs URL cannot be read") from None
        if parts.scheme not in SCHEMES:
            raise ValueError(f"blobs URL starts with '{parts.scheme}://', known are {', '.join(SCHEMES)}")
        region = parse_qs(parts.query).get("region", [None])[0]
        path = unquote(parts.path).strip("/")
        key, secret = (unquote(word) if word else None for word in (parts.username, parts.password))
        if (key is None) != (secret is None):
            raise ValueError("blobs URL has a key without a secret, or the reverse")
        if parts.scheme == "s3":
            return cls(_bucket(parts.hostname or ""), _prefix(path), None, region, key, secret)
        if not parts.hostname:
            raise ValueError("blobs URL names no host")
        host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
        endpoint = f"{parts.scheme.removeprefix('s3+')}://{host}" + (f":{port}" if port else "")
        bucket, _, folder = path.partition("/")
        return cls(_bucket(bucket), _prefix(folder), endpoint, region or "us-east-1", key, secret)


def _bucket(name: str) -> str:
    if not 3 <= len(name) <= 63:
        raise ValueError(f"blobs URL names bucket '{name}'; bucket names have 3 to 63 characters")
    return name


def _prefix(folder: str) -> str:
    return f"{folder.strip('/')}/" if folder.strip("/") else ""
