"""Certificates are read once per process: that costs more than a request to the server next door."""

from __future__ import annotations

import ssl
from functools import lru_cache

import httpx


@lru_cache(maxsize=1)
def tls_context() -> ssl.SSLContext:
    """Verifies as httpx does on its own (SSL_CERT_FILE, SSL_CERT_DIR, else certifi)."""
    return httpx.create_ssl_context()
