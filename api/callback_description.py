"""What OpenAPI says of callbacks: the requests this server sends."""

from __future__ import annotations

from typing import Any

STATUS_INFO = {"$ref": "#/components/schemas/StatusInfo"}
EVENTS = {"jobSuccessful": "successUri", "jobInProgress": "inProgressUri", "jobFailed": "failedUri"}
HEADERS = {
    "webhook-id": "Of the message; the same in every attempt, so that what comes twice can be told",
    "webhook-timestamp": "Seconds since 1970 at this attempt; refuse what is older than five minutes",
    "webhook-signature": "`v1,` and the base64 HMAC-SHA256 of `id.timestamp.body`; several behind spaces while secrets change",
}


def describe_callbacks() -> dict[str, Any]:
    """The member `callbacks` of the operation that executes a process."""
    operation = {
        "post": {
            "parameters": [
                {"name": name, "in": "header", "required": True, "description": told, "schema": {"type": "string"}}
                for name, told in HEADERS.items()
            ],
            "requestBody": {"required": True, "content": {"application/json": {"schema": STATUS_INFO}}},
            "responses": {
                "2XX": {"description": "Taken"},
                "410": {"description": "Not wanted any more: not sent again"},
                "default": {"description": "Sent again, up to ten times within four days; redirects are not followed"},
            },
        }
    }
    return {name: {f"{{$request.body#/subscriber/{member}}}": operation} for name, member in EVENTS.items()}
