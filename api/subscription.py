"""The `subscriber` of an execution: taken only if its callbacks can be signed and may go where they are to go."""

from __future__ import annotations

from starlette.requests import Request

from api.schemas.execution import SubscriberRequest
from api.services import Services
from core.errors import InputError
from store.callback import Subscriber


def read_subscriber(services: Services, request: Request, sent: SubscriberRequest | None) -> Subscriber | None:
    """Raises InputError `callback.not_offered`, and those of `Receivers.require_uri`, which say whose URI it is."""
    if sent is None:
        return None
    if not services.settings.callback_secret:
        raise InputError("callback.not_offered", "this server has no secret to sign callbacks with, so it sends none")
    for name, uri in sent.model_dump(by_alias=True, exclude_none=True).items():
        try:
            services.receivers.require_uri(uri)
        except InputError as error:
            raise InputError(error.code, f"{name}: {error.message}", member=name) from None
    return Subscriber(str(request.base_url), sent.success_uri, sent.in_progress_uri, sent.failed_uri)
