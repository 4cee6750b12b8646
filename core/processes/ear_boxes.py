"""Where both ears of a stored mesh are, before a job uses them. Runs in the limited child."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.ears.find_ears import find_ears
from core.io import canonical
from core.schema.shells import Box


def run(payload: dict[str, Any], channel: object) -> dict[str, Any]:
    """The boxes that `ears: "auto"` takes for the mesh at payload["path"] (canonical form).

    Returns {"ears": [{"name", "box_mm"}]}. Raises: InputError `ears.not_found`, InternalError `canonical.corrupt`."""
    del channel  # a second or two: there is no progress to tell
    ears = find_ears(canonical.load(Path(payload["path"])))
    return {"ears": [{"name": ear.name, "box_mm": rounded_box(ear.low, ear.high).model_dump()} for ear in ears]}


def rounded_box(low: NDArray[np.float64], high: NDArray[np.float64]) -> Box:
    """Corners (3,), (3,) rounded outwards to a tenth of a millimetre: numbers a reader can copy."""
    down, up = np.floor(low * 10) / 10, np.ceil(high * 10) / 10
    return Box(
        min=(float(down[0]), float(down[1]), float(down[2])),
        max=(float(up[0]), float(up[1]), float(up[2])),
    )
