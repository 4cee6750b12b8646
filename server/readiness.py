"""Is the API ready for work, and if not, what does it say is missing?"""

from __future__ import annotations

import json
from http.client import HTTPConnection, HTTPException

PROBE_S = 5.0


def ask_api(host: str, port: int) -> str | None:
    """None if it is ready; else why not, in words for the user."""
    connection = HTTPConnection(host, port, timeout=PROBE_S)
    try:
        connection.request("GET", "/readyz")
        reply = connection.getresponse()
        if reply.status == 200:
            return None
        return str(json.load(reply)["detail"])
    except (OSError, HTTPException) as error:
        return f"no answer on port {port}: {error}"
    except (ValueError, LookupError, TypeError):
        return f"whoever answers on port {port} is not the API"
    finally:
        connection.close()
