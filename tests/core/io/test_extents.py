from __future__ import annotations

import numpy as np
import pytest

from core.io.extents import check_extents
from core.io.unit import Unit
from core.schema.finding import Severity


@pytest.mark.parametrize("longest_mm", [20.0, 60.0, 250.0, 1760.0, 2720.0])
def test_a_human_or_a_part_of_one_is_no_finding(longest_mm: float) -> None:
    assert check_extents(np.array([3.0, longest_mm, 10.0]), "mm", "skin") == []


@pytest.mark.parametrize(
    ("longest_mm", "unit", "hint"),
    [
        (1.76, "mm", "1.76 mm long (1.76 mm as given)"),
        (1.76, "mm", "read as m it would be 1760 mm"),
        (1.76e6, "m", "1.76e+06 mm long (1760 m as given), unlike a human or a part of one: read as mm it would be 1760 mm"),
        (1.76e5, "m", "(176 m as given), unlike a human or a part of one: read as cm it would be 1760 mm"),
        (0.25, "mm", "read as m it would be 250 mm"),
        (1e-3, "mm", "no known unit makes it the size of a human"),
        (1e7, "mm", "no known unit"),
    ],
)
def test_other_sizes_are_told_with_the_unit_that_fits(longest_mm: float, unit: Unit, hint: str) -> None:
    (finding,) = check_extents(np.array([longest_mm / 9, longest_mm, 0.0]), unit, "skin")
    assert (finding.code, finding.severity) == ("mesh.unit_suspicious", Severity.WARNING)
    assert hint in finding.message
