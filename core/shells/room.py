"""Whether the layers asked for fit the body at all; the places where they do not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.mesh import Mesh
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.schema.shells import Layer

Floats = NDArray[np.float64]

ON_TARGET = 0.05  # relative; the contract's tolerance


def require_reachable(skin: Mesh, layers: Sequence[Layer], targets: Floats, usable: Floats) -> None:
    """A layer that can be kept nowhere is a mistake in the request, not thin anatomy; the place with most room is named.

    targets (L, V), usable (V,) mm. Raises: InputError `layer.deeper_than_reach`.
    """
    for layer, wanted in zip(layers, targets, strict=True):
        if not (usable >= (1 - ON_TARGET) * wanted).any():
            deepest = float(usable.max())
            room = "the body" if layer.side == "inside" else "the room around the body"
            raise InputError(
                "layer.deeper_than_reach",
                f"layer '{layer.name}' at {_words(wanted)} lies deeper than {room} allows anywhere: {deepest:.3g} mm",
                findings=(
                    Finding(
                        code="layer.deeper_than_reach",
                        severity=Severity.ERROR,
                        message=f"the most room for layer '{layer.name}' is {deepest:.3g} mm, here",
                        count=len(skin.faces),
                        places=_places(skin, np.flatnonzero((skin.faces == usable.argmax()).any(axis=1))),
                    ),
                ),
                layer=layer.name,
                depth_mm=round(float(wanted.min()), 4),
                deepest_mm=round(deepest, 4),
            )


def require_thick_enough(skin: Mesh, layers: Sequence[Layer], targets: Floats, usable: Floats) -> None:
    """For those who asked that no depth be faded. Raises: InputError `skin.too_thin` with the faces."""
    for layer, wanted in zip(layers, targets, strict=True):
        thin = usable < (1 - ON_TARGET) * wanted
        if thin.any():
            faces = np.flatnonzero(thin[skin.faces].any(axis=1))
            thinnest = float(usable[thin].min())
            room = "the skin is" if layer.side == "inside" else "the room around the skin is"
            finding = Finding(
                code="skin.too_thin",
                severity=Severity.ERROR,
                message=f"layer '{layer.name}' does not fit at {_words(wanted)}; the least room is {thinnest:.3g} mm",
                count=len(faces),
                places=_places(skin, faces),
            )
            raise InputError(
                "skin.too_thin",
                f"at {len(faces)} of {len(skin.faces)} faces {room} too thin for layer '{layer.name}' at "
                f"{_words(wanted)} (least room {thinnest:.3g} mm) and thin_policy is 'fail'; 'adapt' fades the depth there",
                findings=(finding,),
                layer=layer.name,
                faces=len(faces),
                least_room_mm=round(thinnest, 4),
            )


def _words(wanted: Floats) -> str:
    low, high = float(wanted.min()), float(wanted.max())
    return f"{low:g} mm" if low == high else f"{low:.3g} to {high:.3g} mm"


def _places(skin: Mesh, faces: NDArray[np.int64]) -> tuple[Place, ...]:
    """The first faces as places of the skin."""
    named = faces[:MAX_PLACES]
    centres = skin.triangles()[named].mean(axis=1)
    return tuple(
        Place(mesh="skin", point_mm=(float(x), float(y), float(z)), faces=(int(face),))
        for face, (x, y, z) in zip(named, centres, strict=True)
    )
