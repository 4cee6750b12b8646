"""From pydantic's list of errors to violations a user can act on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from api.schemas.problem import Violation
from core.errors import InputError

MAX_VIOLATIONS = 50  # a body may hold thousands of the same mistake
MAX_ECHO = 120  # characters of the offending value that are quoted back
_PARAMETER_PLACES = {"query", "path", "header", "cookie"}
_WRONG_KIND = {"model_type", "model_attributes_type", "list_type", "dict_type", "tuple_type"}
_SAYS_ENOUGH = {"missing", "value_error", "json_invalid"}

ErrorDetails = Mapping[str, Any]
Loc = Sequence[str | int]


class ViolationsError(InputError):
    """Values that do not fit their model; carries every violation. `sent` is what was validated, `base` where it stood."""

    def __init__(self, code: str, unknown_key_code: str, error: ValidationError, *, base: str, sent: object) -> None:
        told = without_noise(error.errors(include_url=False, include_context=False), sent)
        self.violations = violations_of(told, base=base, sent=sent)
        unknown_only = all(violation.type == "extra_forbidden" for violation in self.violations)
        super().__init__(unknown_key_code if unknown_only else code, summarize(self.violations))


def violations_of(errors: Iterable[ErrorDetails], *, base: str = "", sent: object = None) -> tuple[Violation, ...]:
    """The first violations in pydantic's `errors()`; `base` is the JSON pointer of `sent`, the value that was validated."""
    listed = list(errors)[:MAX_VIOLATIONS]
    return tuple(
        Violation(pointer=_pointer(error, base, sent), detail=_sentence(error), type=str(error["type"])) for error in listed
    )


def without_noise(errors: Sequence[ErrorDetails], sent: object) -> list[ErrorDetails]:
    """Only what the user did wrong.

    Where a value may have several forms, pydantic reports what it lacks of each: the form with the least wrong is the one that
    was meant. And a list whose items are wrong is said to be too short: it is not."""
    told: list[ErrorDetails] = []
    forms: dict[Loc, dict[str | int, list[ErrorDetails]]] = {}
    for error in errors:
        steps = _steps_that_lead_on(error["loc"], sent)
        place: tuple[str | int, ...] = tuple(error["loc"][:steps])
        rest = error["loc"][steps:]
        if not rest or (error["type"] == "missing" and len(rest) == 1):
            told.append(error)
        else:
            forms.setdefault(place, {}).setdefault(rest[0], []).append(error)
    for where, by_form in forms.items():
        of_its_kind = [group for group in by_form.values() if not _is_of_another_kind(group, len(where))]
        if of_its_kind:
            meant: list[ErrorDetails] = min(of_its_kind, key=len)
            told += meant
        else:
            told += [error for group in by_form.values() for error in group]
    return [error for error in told if not (error["type"] == "too_short" and any(_is_below(other, error) for other in told))]


def _is_of_another_kind(group: list[ErrorDetails], depth: int) -> bool:
    """True for a form that wants an object where a list was sent, and the like."""
    return any(error["type"] in _WRONG_KIND and len(error["loc"]) == depth + 1 for error in group)


def _is_below(error: ErrorDetails, other: ErrorDetails) -> bool:
    return len(error["loc"]) > len(other["loc"]) and error["loc"][: len(other["loc"])] == other["loc"]


def _steps_that_lead_on(loc: Loc, sent: Any) -> int:
    """How many steps of `loc` one can take in what was sent, from the start."""
    for position, part in enumerate(loc):
        if not _leads_on(part, sent):
            return position
        sent = sent[part]
    return len(loc)


def summarize(violations: Sequence[Violation]) -> str:
    """All violations in one line for `detail`."""
    shown = "; ".join(f"{violation.pointer or 'body'}: {violation.detail}" for violation in violations[:5])
    return shown + (f"; and {len(violations) - 5} more" if len(violations) > 5 else "")


def _pointer(error: ErrorDetails, base: str, sent: object) -> str:
    loc: Loc = error["loc"]
    if loc and loc[0] in _PARAMETER_PLACES:
        return str(loc[-1])
    parts = loc[1:] if loc and loc[0] == "body" else loc
    kept = parts if sent is None else _really_there(parts, sent, missing=error["type"] == "missing")
    return base + "".join("/" + _step(part) for part in kept)


def _step(part: str | int) -> str:
    """Escaped for a JSON pointer, and fit to be sent: keys may hold lone surrogates."""
    plain = str(part)[:MAX_ECHO].encode("utf-8", "backslashreplace").decode()
    return plain.replace("~", "~0").replace("/", "~1")


def _really_there(parts: Loc, sent: Any, *, missing: bool) -> list[str | int]:
    """Without the names pydantic gives to the forms of a union: only steps one can take in what was sent."""
    kept: list[str | int] = []
    for position, part in enumerate(parts):
        if _leads_on(part, sent):
            sent = sent[part]
        elif not (missing and position == len(parts) - 1):
            continue
        kept.append(part)
    return kept


def _leads_on(part: str | int, sent: object) -> bool:
    if isinstance(sent, Mapping):
        return part in sent
    return isinstance(sent, list | tuple) and isinstance(part, int) and part < len(sent)


def _sentence(error: ErrorDetails) -> str:
    if error["type"] == "extra_forbidden":
        return "there is no such key"
    message = str(error["msg"]).removeprefix("Value error, ")
    message = message[:1].lower() + message[1:]
    value = error.get("input")
    if error["type"] in _SAYS_ENOUGH or isinstance(value, dict | list | tuple):
        return message
    shown = repr(value)
    return f"{message}, got {shown if len(shown) <= MAX_ECHO else shown[:MAX_ECHO] + '…'}"
