"""The laws of the rheology by name, on whatever calculates like an array."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
import xarray as xr
from helpers.cases import small

from warpgran.case.sections import Rheology
from warpgran.physics import laws

LAWS = get_args(Rheology.model_fields["phi_eq"].annotation)
I = np.array([0.0, 0.1, 1.0, 10.0])


def test_every_law_of_the_run_file_is_in_the_table() -> None:
    assert set(laws.PHI_EQ) == set(LAWS)


def test_a_law_that_is_not_in_the_table_is_an_error() -> None:
    case = small()
    unknown = case.model_copy(update={"rheology": case.rheology.model_copy(update={"phi_eq": "f3"})})
    with pytest.raises(KeyError, match="f3"):
        laws.phi_equilibrium(I, unknown)


@pytest.mark.parametrize("law", LAWS)
def test_laws_fall_from_phi_stat_and_take_labelled_arrays(law: str) -> None:
    phi_eq = laws.PHI_EQ[law](I, 0.2, 0.582, 1.5)
    assert phi_eq[0] == 0.582
    assert (np.diff(phi_eq) < 0.0).all() and phi_eq[-1] >= 0.0
    labelled = xr.DataArray(I, dims="x"), xr.DataArray([0.2, 0.3], dims="run")
    per_run = laws.PHI_EQ[law](*labelled, 0.582, 1.5).transpose("run", "x")
    np.testing.assert_array_equal(per_run[0], phi_eq)


def test_f2_is_f1_in_the_limit_of_large_N() -> None:
    np.testing.assert_allclose(laws.PHI_EQ["f2"](I, 0.2, 0.582, 1e8), laws.PHI_EQ["f1"](I, 0.2, 0.582, 1.0), rtol=1e-6)


def test_mu_of_I_goes_from_mu1_to_mu2_and_is_half_way_at_I0() -> None:
    mu = laws.mu_of_I(np.array([0.0, 0.279, 1e12]), 0.48, 0.73, 0.279)
    np.testing.assert_allclose(mu, [0.48, 0.605, 0.73], rtol=1e-12)


def test_friction_is_not_negative_without_its_walls() -> None:
    assert laws.effective_friction(0.48, -1.0, 0.05) == 0.05
