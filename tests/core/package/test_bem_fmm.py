"""Index files keep the digits of every conductivity."""

from dataclasses import replace

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from core.package.bem_fmm import matlab_index, python_index
from tests.core.package.nested import tissues


@given(conductivity=st.floats(1e-6, 1e3))
def test_numbers_survive_both_indices(conductivity):
    skin = replace(tissues()[0], conductivity_s_per_m=conductivity)
    row = matlab_index([skin]).splitlines()[1]
    assert row.count(":") == 3
    assert float(row.split(":")[2]) == pytest.approx(conductivity, rel=1e-9)
    assert yaml.safe_load(python_index([skin]))["shells"]["skin"][0] == pytest.approx(conductivity, rel=1e-9)


def test_usual_numbers_have_four_decimals():
    assert ">skin : skin.mat : 0.4650 : FreeSpace\n" in matlab_index(tissues())
