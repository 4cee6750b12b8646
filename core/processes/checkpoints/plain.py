"""What a step made as JSON and arrays, and back bit for bit. Reading runs no code: only classes of `core` are filled again."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

Array = NDArray[np.generic]

NUMBERS = "biuf"  # kinds of arrays: flags, whole and real numbers
HOME = "core."


@dataclass(frozen=True, eq=False, slots=True)
class Plain:
    """tree: JSON; {"array": i} stands for arrays[i], other objects with one key of `_DECODERS` for what JSON has no word for."""

    tree: Any
    arrays: tuple[Array, ...]


def to_plain(value: object) -> Plain:
    """Take apart frozen dataclasses, pydantic models, enums, arrays, tuples, lists, dicts, text and numbers.

    Raises TypeError for anything else: a step must make values, not things that live.
    """
    arrays: list[Array] = []
    return Plain(_encode(value, arrays), tuple(arrays))


def from_plain(plain: Plain) -> Any:
    """The inverse of `to_plain`; arrays lie in C order. Raises ValueError, TypeError, KeyError if `plain` does not fit."""
    return _decode(plain.tree, plain.arrays)


def _encode(value: object, arrays: list[Array]) -> Any:
    if isinstance(value, Enum):
        return {"enum": [_name(type(value)), value.value]}
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, np.bool_ | np.integer | np.floating):
        value = value.item()
    if isinstance(value, bool | int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"float": repr(value)}
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in NUMBERS:
            raise TypeError(f"an array of {value.dtype} is no array of numbers")
        arrays.append(value)
        return {"array": [len(arrays) - 1, value.flags.writeable]}
    if type(value) is tuple:
        return {"tuple": [_encode(item, arrays) for item in value]}
    if isinstance(value, list):
        return [_encode(item, arrays) for item in value]
    if isinstance(value, Mapping):
        return {"dict": [[_encode(key, arrays), _encode(item, arrays)] for key, item in value.items()]}
    if isinstance(value, BaseModel):
        names = [name for name in type(value).model_fields if name in value.model_fields_set]
    elif is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in fields(value)]
    else:
        raise TypeError(f"a {type(value).__name__} cannot be kept")
    return {"object": [_name(type(value)), {name: _encode(getattr(value, name), arrays) for name in names}]}


def _decode(tree: Any, arrays: tuple[Array, ...]) -> Any:
    if isinstance(tree, list):
        return [_decode(item, arrays) for item in tree]
    if not isinstance(tree, dict):
        return tree
    [(kind, content)] = tree.items()
    if kind == "float":
        return float(content)
    if kind == "tuple":
        return tuple(_decode(item, arrays) for item in content)
    if kind == "dict":
        return {_decode(key, arrays): _decode(item, arrays) for key, item in content}
    if kind == "array":
        number, writeable = content
        array = np.array(arrays[number], order="C")
        array.setflags(write=writeable)
        return array
    if kind == "enum":
        name, item = content
        return _class(name)(item)
    if kind == "object":
        name, told = content
        made = _class(name)
        values = {key: _decode(item, arrays) for key, item in told.items()}
        return made.model_validate(values) if issubclass(made, BaseModel) else made(**values)
    raise ValueError(f"unknown kind {kind!r}")


def _name(kind: type) -> str:
    if not kind.__module__.startswith(HOME):
        raise TypeError(f"{kind.__module__}.{kind.__qualname__} is none of our classes")
    return f"{kind.__module__}:{kind.__qualname__}"


def _class(name: str) -> Any:
    """A dataclass, model or enum of ours that is loaded already."""
    module, _, kind = name.partition(":")
    found = getattr(sys.modules[module], kind, None) if module.startswith(HOME) else None
    if not (isinstance(found, type) and (is_dataclass(found) or issubclass(found, BaseModel | Enum))):
        raise ValueError(f"{name} is no class of values")
    return found
