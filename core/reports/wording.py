"""Numbers and codes in the words of the report: units people read, no more digits than are true."""

from __future__ import annotations

from typing import Any

from core.schema.report import PairReport, Relation, StepOutcome

MM2_PER_CM2 = 100.0
MM3_PER_LITRE = 1e6
MM3_PER_CM3 = 1e3
NOT_KNOWN = "–"
THIN_SPACE = "\u202f"
MOST_NUMBERS = 12
ROUNDING = 1e-9  # of numbers of any unit
NOTHING_MM = 1e-6  # the last digit of coordinates of a body in single precision is larger

_RELATIONS: dict[Relation, str] = {
    "a_inside_b": "{a} lies inside {b}",
    "b_inside_a": "{b} lies inside {a}",
    "disjoint": "apart, neither inside the other",
    "intersecting": "they intersect",
    "undetermined": "cannot be told",
}

_OUTCOMES: dict[StepOutcome, str] = {
    "done": "done",
    "not_needed": "not needed",
    "failed": "failed",
    "not_reached": "not reached",
}


def whole(value: int | None) -> str:
    """`107 024`."""
    return NOT_KNOWN if value is None else f"{value:,}".replace(",", THIN_SPACE).replace("-", "−")


def significant(value: float | None, digits: int = 3) -> str:
    """`0.0213`, `12.4`, `1 240`; never an exponent for what people can read."""
    if value is None:
        return NOT_KNOWN
    if value == 0 or 1e-4 <= abs(value) < 1e9:
        text = f"{value:.{digits}g}"
        return whole(round(value)) if "e" in text or "." not in text else text.replace("-", "−")
    return f"{value:.{digits - 1}e}".replace("-", "−")


def distance(mm: float | None) -> str:
    """`0.346 mm`; what is rounding alone is `0 mm`."""
    return NOT_KNOWN if mm is None else f"{significant(mm if abs(mm) >= NOTHING_MM else 0.0)} mm"


def depth(mm: float | None) -> str:
    """`1.000`: three digits after the point in every row of a column."""
    return NOT_KNOWN if mm is None else f"{mm:.3f}".replace("-", "−")


def area(mm2: float | None) -> str:
    """In cm², for a body in m²."""
    if mm2 is None:
        return NOT_KNOWN
    cm2 = mm2 / MM2_PER_CM2
    return f"{cm2 / 1e4:.4f} m²" if cm2 >= 1e3 else f"{significant(cm2, 4)} cm²"


def volume(mm3: float | None) -> str:
    """In cm³, for a body in litres."""
    if mm3 is None:
        return NOT_KNOWN
    return f"{mm3 / MM3_PER_LITRE:.3f} l" if abs(mm3) >= MM3_PER_LITRE else f"{significant(mm3 / MM3_PER_CM3, 4)} cm³"


def percent(share: float | None) -> str:
    """`98.62 %`; what is not all is never rounded up to 100 %."""
    if share is None:
        return NOT_KNOWN
    if 0 < share < 1:
        return f"{min(max(100 * share, 0.01), 99.99):.2f} %"
    return f"{100 * share:g} %"


def drift(share: float | None) -> str:
    """`+0.12 %`, `−1.3 %`; two digits, because a small change of a volume is what one looks for."""
    if share is None:
        return NOT_KNOWN
    text = f"{100 * share:+.2g} %" if abs(share) >= 1e-6 else "0 %"
    return text.replace("-", "−")


def yes_no(value: bool | None) -> str:
    """`yes`, `no`, or not known."""
    return NOT_KNOWN if value is None else ("yes" if value else "no")


def point(mm: tuple[float, float, float] | None) -> str:
    """`(12.3, −4.0, 801.2)`."""
    return NOT_KNOWN if mm is None else "(" + ", ".join(f"{value:.1f}" for value in mm).replace("-", "−") + ")"


def spot(mm: tuple[float, float, float]) -> str:
    """A point as the viewer reads it: `12.300 -4.000 801.200`."""
    return " ".join(f"{value:.3f}" for value in mm)


def numbers(values: tuple[int, ...]) -> str:
    """The first few of many."""
    shown = ", ".join(map(str, values[:MOST_NUMBERS]))
    return shown + (f" and {len(values) - MOST_NUMBERS} more" if len(values) > MOST_NUMBERS else "")


def relation(pair: PairReport) -> str:
    """How two meshes lie to each other."""
    return _RELATIONS[pair.relation].format(a=pair.a, b=pair.b)


def title_of(code: str) -> str:
    """`shells.depth_missed` -> `Shells: depth missed`."""
    noun, _, reason = code.replace("_", " ").partition(".")
    return f"{noun[:1].upper()}{noun[1:]}: {reason}" if reason else noun


def outcome(step: StepOutcome) -> str:
    """What became of a step."""
    return _OUTCOMES[step]


def quantity(value: float | int | str) -> str:
    """A number of a step: counts whole, the rest with four digits, words as they are."""
    if isinstance(value, bool):
        return yes_no(value)
    if isinstance(value, float):
        return significant(value if abs(value) >= ROUNDING else 0.0, 4)
    return whole(value) if isinstance(value, int) else value


def flattened(parameters: dict[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Nested parameters as rows: `layers[0].depth_mm` -> `1`."""
    rows: list[tuple[str, str]] = []
    for key, value in parameters.items():
        rows += _flattened_value(f"{prefix}{key}", value)
    return rows


def _flattened_value(path: str, value: Any) -> list[tuple[str, str]]:
    if isinstance(value, dict) and value:
        return flattened(value, f"{path}.")
    if isinstance(value, list | tuple) and any(isinstance(item, dict | list | tuple) for item in value):
        return [row for index, item in enumerate(value) for row in _flattened_value(f"{path}[{index}]", item)]
    if isinstance(value, list | tuple):
        return [(path, ", ".join(map(_parameter, value)) or NOT_KNOWN)]
    return [(path, _parameter(value))]


def _parameter(value: Any) -> str:
    """As it was asked for: every digit, and `1` for 1.0."""
    if value is None or value == {}:
        return NOT_KNOWN
    if isinstance(value, bool):
        return yes_no(value)
    return f"{value:.15g}".replace("-", "−") if isinstance(value, float) else str(value)
